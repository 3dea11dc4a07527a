"""What is hidden is no effect of the catalogue: the right answer names nothing."""

import numpy as np

from .campaign import FREE, LEAST_SQUARES, SMALL_PSO, Campaign, declare, identify, validate, weights
from .drives import Drive
from .dynamics import lag
from .hysteresis import two_groups


@declare("n01", "outside")
def contact_and_slip():
    """Contact that adds 28 % of stiffness above 5.1 um and a slip that softens it above 8.3 um: two kinks in x(f)
    (piecewise linear springs)."""

    def mechanics(f, at):
        touched = np.where(f > 5.1, 5.1 + (f - 5.1) / (1 + 0.28), f)
        return np.where(touched > 8.3, touched + (touched - 8.3) * 0.35, touched)

    def drive(rest=0.2):
        return Drive(2000).rest(rest)

    bias = drive().loops(4, 35, 3).ramp(30, 0.2).loops(4, 35, 3).ramp(60, 0.2).loops(4, 35, 3).rest(0.2)
    return Campaign(
        title="Gripper finger, 12 um",
        records=[
            identify("tri", drive(0.3).triangles(1.5, 100, 3).rest(0.3)),
            identify("bias", bias),
            validate("val", drive().reversals([90, 10, 70, 30, 100, 0], 200).loops(5, 50, 4).rest(0.2)),
        ],
        hidden={"mechanics": mechanics},
        parameters={"x": {"gain": 0.128, "alpha": 0.3, "beta": 0.02, "gamma": 0.02}},
        bounds=FREE,
        model="[bouc_wen]",
        counts=0.01,
        format="mat",
    )


@declare("n17", "outside")
def air_conditioning():
    """Expansion by 160 nm that follows an air-conditioning, which switches after irregular 4 to 11 s, by two lags of
    1.6 and 0.5 s (Newton's law of cooling)."""

    def switched(seed):
        rng = np.random.default_rng(seed)
        time, state, switches = -rng.uniform(0, 12), rng.integers(0, 2), []
        while time < 90:
            switches.append((time, state))
            time += rng.uniform(4, 11)
            state = 1 - state
        return switches

    rooms = [switched(170 + number) for number in range(5)]

    def reading(x, at):
        warm = np.zeros_like(x)
        for time, state in rooms[at.number]:
            warm[at.times >= time] = state
        return x + 0.16 * (lag(lag(warm, at.step, 1.6), at.step, 0.5) - warm[0])

    def drive(rest=2):
        return Drive(200).rest(rest)

    return Campaign(
        title="Long-range stage, room with air-conditioning",
        records=[
            identify("l1", drive().triangles(0.3, 100, 4).rest(8).loops(1, 60, 10).rest(5)),
            identify("l2", drive(3).stairs([20, 50, 80, 60, 30], 5).rest(4)),
            identify("l3", drive().loops(0.25, 100, 6).rest(6)),
            identify("null", drive(30)),
            validate("v", drive().reversals([90, 20, 70, 40, 100, 0], 18).rest(8)),
        ],
        hidden={"reading": reading},
        parameters={"x": {"gain": 0.18, "alpha": 0.35, "beta": 0.022, "gamma": 0.02}},
        bounds=FREE,
        model="[bouc_wen]",
    )


@declare("n19", "outside")
def two_clocks():
    """The sensor's clock is off by 0, +0.45, -0.3 and +0.38 % in the four records: a delay that grows from the start,
    with another sign in one of them; Preisach hysteresis with two groups of coercive voltages."""
    errors = [0.0, 0.0045, -0.003, 0.0038]
    fields, shares = two_groups(10, 36, 65)

    def drive():
        return Drive(1000).rest(0.5)

    return Campaign(
        title="Drive and sensor on two recorders, started by one trigger",
        base="preisach",
        records=[
            identify("a", drive().loops(2, 120, 6).rest(0.3)),
            identify("b", drive().reversals([110, 40, 90, 20, 120, 0], 250).loops(4, 60, 8).rest(0.3)),
            identify("c", drive().triangles(1.5, 100, 5).rest(0.3)),
            validate("v", drive().loops(3, 90, 9).rest(0.3)),
        ],
        hidden={"reading": lambda x, at: np.interp(at.times * (1 + errors[at.number]), at.times, x)},
        parameters={"x": {"gain": 0.1, "interaction": 55.0, "fields": fields, "weights": 6.0 * shares}},
        model="[{name: homogenized_energy, density: free}]",
        more={"homogenized_energy.interaction": [10, 300]},
        steps=2,
        counts=0.03,
        optimizers=(LEAST_SQUARES,),
        repeats=1,
    )


@declare("n23", "outside")
def leaking_charge():
    """dU_a/dt = dU/dt - U_a / 45 s (|U_a| / 62 V)^3: charge that leaks through a resistance which falls with the
    voltage (charge amplifier, Comstock 1981)."""

    def leaking(u, at):
        out = np.empty_like(u)
        value = out[0] = u[0]
        for i in range(1, len(u)):
            value += u[i] - u[i - 1] - at.step * value / 45.0 * (abs(value) / 62.0) ** 3
            out[i] = value
        return out

    def drive():
        return Drive(500).rest(1)

    return Campaign(
        title="Stack behind a charge amplifier",
        base="prandtl_ishlinskii",
        records=[
            identify("steps", drive().stairs([40, 90, 120, 60], 4).rest(1)),
            identify("loops", drive().loops(1, 120, 5).loops(1, 50, 5).rest(1)),
            identify("slow", drive().triangles(0.15, 110, 1).rest(1)),
            validate("val", drive().ramp(100, 0.5).rest(3).reversals([30, 110, 60, 80, 0], 100).rest(2)),
        ],
        hidden={"drive": leaking},
        parameters={"x": dict(gain=0.08, reach=56.0, **weights(0.015, 0.012, 0.01, 0.008, 0.006, 0.004, 0.002, 0.002))},
        bounds={"reach": "fix"},
        model="[prandtl_ishlinskii]",
        noise=0.02,
        drive_counts=0.005,
    )


@declare("n25", "outside")
def fringe_jumps():
    """The reading jumps by +-316.4 nm, half a wavelength, at one or two instants of each record: an interferometer that
    loses count."""
    jumps = [[(1.7, 1)], [(0.9, -1), (2.6, -1)], [(2.2, 1)], [(1.4, 1), (3.1, -1)]]

    def reading(x, at):
        return x + 0.3164 * sum(sign * (at.times > time) for time, sign in jumps[at.number])

    def drive():
        return Drive(1000).rest(0.4)

    return Campaign(
        title="Interferometer HeNe, stage of 16 um",
        records=[
            identify("l1", drive().triangles(2, 120, 5).rest(0.5)),
            identify("l2", drive().loops(3, 90, 8).rest(0.5)),
            identify("l3", drive().stairs([30, 70, 50, 110, 40, 0], 0.5)),
            validate("v", drive().reversals([100, 30, 80, 45, 110, 0], 150).rest(0.8)),
        ],
        hidden={"reading": reading},
        parameters={"x": {"gain": 0.145, "alpha": 0.33, "beta": 0.02, "gamma": 0.03}},
        bounds=FREE,
        model="[bouc_wen]",
        counts=0.0099,
    )


@declare("n28", "outside")
def aging():
    """The gain ages from record to record: 1, 0.988, 0.974 and 0.965 to identify, 0.981 and 0.958 to validate;
    free-energy hysteresis."""
    rng = np.random.default_rng(28)
    gains = [1, 0.988, 0.974, 0.965, 0.981, 0.958]

    def drive():
        return Drive(500).rest(0.5)

    return Campaign(
        title="Actuator measured over six weeks",
        base="homogenized_energy",
        records=[
            identify("d1", drive().triangles(1, 100, 3).rest(0.5)),
            identify("d8", drive().triangles(1, 100, 3).rest(0.5)),
            identify("d20", drive().reversals([90, 20, 70, 40, 100, 0], 150).rest(0.5)),
            identify("d31", drive().triangles(1, 60, 3).rest(0.5)),
            validate("d12", drive().triangles(2, 75, 4).rest(0.5)),
            validate("d40", drive().multisine([0.5, 0.01], 0, 0.1, rng).loops(0.8, 95, 3).rest(0.5)),
        ],
        hidden={"stroke": lambda f, at: f * gains[at.number]},
        parameters={"x": {"gain": 0.05, "remanence": 85.0, "coercive": 28.0, "spread": 0.65, "interaction": 60.0}},
        bounds={"gain": "wide", "remanence": "wide", "coercive": "wide", "spread": [0.2, 1.5], "interaction": "wide"},
        model="[homogenized_energy]",
        drive_counts=0.003,
        optimizers=(SMALL_PSO,),
    )


@declare("n32", "outside")
def coupling_by_product():
    """The readings are coupled by the product of both displacements: x gains 0.0021 (x - 6)(y - 7) um, and y loses 0.6
    of it (second-order geometry)."""

    def readings(moved, at):
        x, y = moved["x"], moved["y"]
        return {"x": x + 0.0021 * (x - 6) * (y - 7), "y": y - 0.6 * 0.0021 * (x - 6) * (y - 7)}

    def drive():
        return Drive(1000)

    return Campaign(
        title="XY stage, both sensors",
        records=[
            identify("x", drive().loops(2, 100, 4), drive().rest(3)),
            identify("y", drive().rest(3), drive().loops(2, 100, 4)),
            identify("both", drive().loops(1.7, 90, 6), drive().loops(2.9, 90, 9)),
            validate("raster", drive().triangles(5, 100, 20), drive().ramp(100, 4)),
        ],
        measured=("x", "y"),
        hidden={"readings": readings},
        parameters={
            "x": {"gain": 0.14, "alpha": 0.35, "beta": 0.02, "gamma": 0.02},
            "y": {"gain": 0.15, "alpha": 0.33, "beta": 0.024, "gamma": 0.018},
        },
        bounds={"gain": "wide", "alpha": [0, 1]},
        model="[bouc_wen]",
    )


@declare("n35", "outside")
def cogging():
    """Cogging of 55 nm on the reading, whose period falls from 6.3 to 1.9 um along the stroke and whose size changes by
    half (magnetic cogging with a chirped pitch)."""

    def reading(x, at):
        wave = np.sin(2 * np.pi * (x / 6.3 + 0.06 * x * x / 6.3 + 0.2))
        return x + 0.055 * wave * (1 + 0.5 * np.sin(2 * np.pi * x / 17))

    rng = np.random.default_rng(35)

    def drive():
        return Drive(600)

    return Campaign(
        title="Stage with a magnetic counterbalance",
        records=[
            identify("tri", drive().triangles(0.5, 110, 2)),
            identify("sin", drive().loops(1.3, 70, 4).ramp(50, 0.5).loops(1.3, 60, 4)),
            validate("stair", drive().stairs([12, 35, 61, 90, 74, 43, 20], 0.6)),
            validate("rnd", drive().ramp(55, 0.5).noise(0.1, 3, 52, 8, rng)),
        ],
        hidden={"reading": reading},
        parameters={"x": {"gain": 0.2, "alpha": 0.32, "beta": 0.02, "gamma": 0.02}},
        bounds=FREE,
        model="[bouc_wen]",
        memory=0.5,
        coloured=0.3,
        unit="nm",
    )
