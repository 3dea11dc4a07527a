"""A stage of another family: what Bouc-Wen, alone and with plays beside it, leaves of its hysteresis."""

import numpy as np
from scipy.optimize import least_squares

from .mechanics import carry
from .operators import bouc_wen, plays
from .stage import Axis, actuate
from .visibility import Rig

# As `pzt-ident show distributed_memory` prints: plays, the reach over the swing of the drive, and some of its knees.
PLAYS, REACH, KNEES = 10, 0.4, (0.0, 1.0, 2.0, 4.0, 8.0)


class Family(Rig):
    """The stage, for a user whose model is Bouc-Wen; an effect must be seen beside that and the memory it lacks."""

    def hold_base(self):
        """Directions as ever, and those of Bouc-Wen with plays; what is left of the base, in noise floors."""
        super().hold_base()
        modes = self._mode_directions()
        own, turned = self._bouc_wen_directions(), self._turned_plays()
        choices = [self._forces(np.tanh(k * turned) / k if k else turned) for k in KNEES]
        left = [self._floors(self.span(own + plays + modes)) for plays in choices]
        best = min(range(len(KNEES)), key=lambda i: left[i]["all"])
        self.left = {"alone": self._floors(self.span(own + modes)), "with_plays": left[best], "knee": KNEES[best]}
        self.basis = self.span([*self.basis.T, *own, *choices[best]])
        self.least = max(3.0, left[best]["all"])

    def memory_is_seen(self):
        """Whether Bouc-Wen alone leaves three noise floors, and 1.5 in a record of either use."""
        seen = zip(self.records, self.left["alone"]["records"], strict=True)
        return self.left["alone"]["all"] >= 3.0 and len({r.use for r, share in seen if share > 1.5}) == 2

    def _floors(self, basis):
        left = self.rest - basis @ (basis.T @ self.rest)
        return {"all": round(float(np.sqrt(np.mean(left**2))) / self.floor, 2), "records": self.seen(left)}

    def _trace_of(self, **base):
        return self.trace({"x": Axis(base, self.axes["x"].modes)})

    def _bouc_wen_directions(self):
        """The trace of the Bouc-Wen operator next to the base, and its changes with each parameter."""
        values = self.nearest_bouc_wen()
        found = self._trace_of(kind="bouc_wen", **values)
        changed = [values | {key: 1.01 * value} for key, value in values.items()]
        return [found, *(self._trace_of(kind="bouc_wen", **v) - found for v in changed)]

    def nearest_bouc_wen(self, most=1500):
        """Gain, alpha, beta and gamma by least squares on the operator alone, on every n-th voltage of each record."""
        drives = [r.drives["x"][:: max(1, r.samples // most)] for r in self.records]
        still = Axis(self.axes["x"].base, [])
        goal = [actuate(still, u, np.arange(len(u)), 1.0, 0)[0] for u in drives]
        swing = float(np.ptp(np.concatenate(drives)))
        gain = float(np.ptp(np.concatenate(goal))) / swing

        def named(point):
            g, a, b, c = point
            return {"gain": gain * g, "alpha": a, "beta": b / swing, "gamma": c / swing}

        def misfit(point):
            return np.concatenate([(bouc_wen(u, **named(point)) - y) for u, y in zip(drives, goal, strict=True)])

        limits = ([0.2, 0.0, 0.01, -30.0], [5.0, 1.0, 60.0, 60.0])
        starts = ([1.2, 0.4, 4.0, 1.0], [1.2, 0.3, 1.0, -0.5])
        best = min(
            (least_squares(misfit, s, bounds=limits, x_scale=(1, 0.3, 2, 2)) for s in starts), key=lambda f: f.cost
        )
        return {key: float(value) for key, value in named(best.x).items()}

    def _turned_plays(self):
        """The plays that the catalogue can add, over the swing of the drive, all records end to end."""
        drives = [r.drives["x"] for r in self.records]
        swing = float(np.ptp(np.concatenate(drives)))
        widths = REACH * np.arange(1, PLAYS + 1) / PLAYS
        return np.concatenate([plays(u / swing, widths) for u in drives])

    def _forces(self, columns):
        """Readings of a stage that these forces push, a list of traces."""
        out = np.empty_like(columns)
        for record, a, b in zip(self.records, self.offsets[:-1], self.offsets[1:], strict=True):
            for i, force in enumerate(columns[a:b].T):
                out[a:b, i] = carry(force, force, 1 / record.rate, {"modes": self.axes["x"].modes})
        return list(out.T)
