"""One effect: of the mechanics."""

from .campaign import EVOLUTION, Campaign, declare, identify, validate
from .drives import chirp, cosines, multisine, nested, path, stairs
from .dynamics import chain, lumped, oscillator
from .stages import KILOVOLT, LONG, STACK


@declare("a02", "single", cubic_stiffness=[])
def stretched_leaves():
    """A 100 um amplified flexure stage whose fixed-guided leaves stretch at large stroke. Duffing equation
    m x'' + b x' + k x + k3 x^3 = k f (Awtar & Slocum 2007), k3/k = 6e-7 /um^2; small chirps at three biases show the
    resonance go up."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": LONG},
        records=(
            identify("loops", path(1000, [0, 150, 0, 75, 20, 130, 0], 200, 0.4)),
            identify("sweep_b20", chirp(4000, 20, 1.5, 20, 600, 2.0, 0.3, 0.5)),
            identify("sweep_b130", chirp(4000, 130, 1.5, 20, 600, 2.0, 0.3, 0.5)),
            validate("sweep_b80", chirp(4000, 80, 2, 20, 600, 2.0, 0.3, 0.5)),
            validate("val_sines", cosines(1000, [150, 110, 60], [1.1, 1.7, 3.1], 3, 0.3)),
        ),
        noise=0.012,
        finest=60000,
        hidden={"mechanics": lambda force, at: oscillator(force, at.step, **at.mechanics(), cubic=6e-7)},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "tight"},
        format="mat",
    )


@declare("a03", "single", friction=[])
def dragging_cable():
    """A 100 um stage on a roller guide with a dragging cable. Dahl (1976) bristle friction acting on the moving mass,
    m x'' + b x' + k x + k F = k f, dF/dt = sigma (v - |v| F / Fc), Fc = 0.35 um of stroke, built up over 1.5 um; sweeps
    of three amplitudes show the amplitude-dependent damping."""

    def mechanics(force, at):
        return oscillator(force, at.step, **at.mechanics(), bristle=1 / 1.5 * 0.35, slip=0.35)

    return Campaign(
        base="bouc_wen",
        parameters={"x": LONG},
        records=(
            identify("loops", path(1000, [0, 150, 0, 75, 20, 130, 0], 200, 0.4)),
            identify("sweep_1V", chirp(4000, 60, 1, 30, 500, 1.5, 0.3, 0.4)),
            identify("sweep_4V", chirp(4000, 60, 4, 30, 500, 1.5, 0.3, 0.4)),
            validate("sweep_2V", chirp(4000, 90, 2, 30, 500, 1.5, 0.3, 0.4)),
            validate("val_loops", nested(1000, 140, [1, 0.1, 0.6, 0.3, 0.5, 0], 150, 0.3)),
        ),
        noise=0.012,
        finest=60000,
        hidden={"mechanics": mechanics},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide2", "stiffness": "fix"},
        optimizers=EVOLUTION,
    )


@declare("a04", "single", load_mass=[])
def sample_holder():
    """A stack stage whose job still holds the mass of the empty platform, while a 45 g sample holder is bolted on.
    (m + load) x'' + b x' + k x = k f with mass and stiffness fixed from the data sheet."""

    def mechanics(force, at):
        return lumped(force, at.step, **at.mechanics(mass=at.parameters["mass"] + 0.045))

    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        records=(
            identify("loops", path(1000, [0, 100, 0, 60, 10, 90, 0], 150, 0.4)),
            identify("sweep", chirp(20000, 50, 3, 50, 2500, 0.5, 0.05, 0.05)),
            validate("ms_val", multisine(20000, 60, 6, 40, 2000, 25, 0.5, 11)),
            validate("steps_val", stairs(10000, [20, 60, 50, 0], 40000, 0.1, 0.05)),
        ),
        noise=0.012,
        hidden={"mechanics": mechanics},
        bounds={"gain": "tight", "mass": "fix", "damping": "wide", "stiffness": "fix", "beta": "wide"},
        format="tdms",
    )


@declare("a07", "single", viscous_damping=[])
def squeezed_film():
    """A 100 um stage with a squeeze-film plate 600 um from the platform, damping of the bare stage fixed in the job.
    b -> b + b0 / (1 - x/g)^3 (Bao & Yang 2007), b0 = 60 N s/m; sweeps at low and high bias."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": LONG},
        records=(
            identify("loops", path(1000, [0, 150, 0, 75, 20, 130, 0], 200, 0.4)),
            identify("sweep", chirp(4000, 30, 2, 20, 700, 2.0, 0.3, 0.4)),
            validate("ms", multisine(4000, 50, 5, 20, 500, 30, 2.0, 3, 0.3, 0.4)),
            validate("steps", stairs(4000, [20, 60, 40, 0], 20000, 0.3, 0.1)),
        ),
        noise=0.015,
        finest=60000,
        hidden={"mechanics": lambda force, at: oscillator(force, at.step, **at.mechanics(), gap=600.0, film=60.0)},
        bounds={"gain": "tight", "mass": "fix", "damping": "fix", "stiffness": "fix", "alpha": "wide"},
        format="h5",
    )


@declare("a25", "single", resonance=[])
def carrier_on_a_soft_mount():
    """A kV stack with a sample carrier that sits on a soft mount: chain of two masses, m2 = 60 g on its own spring at
    1450 Hz, the platform m1 is measured, so that an antiresonance at 1450 Hz lies between two peaks."""

    def mechanics(force, at):
        return chain(force, at.step, **at.mechanics(), second=0.06, frequency=1450.0, ratio=0.01)

    return Campaign(
        base="bouc_wen",
        parameters={"x": KILOVOLT},
        records=(
            identify("loops", path(1000, [0, 1000, 0, 600, 100, 900, 0], 1500, 0.4)),
            identify("sweep", chirp(20000, 400, 20, 100, 4000, 0.8, 0.1, 0.1)),
            validate("ms", multisine(20000, 500, 60, 100, 3000, 40, 0.6, 9, 0.1, 0.1)),
            validate("steps", stairs(20000, [200, 500, 0], 3e5, 0.1, 0.1)),
        ),
        noise=0.015,
        steps=10,
        hidden={"mechanics": mechanics},
        bounds={"gain": "tight", "mass": "tight", "damping": "wide", "stiffness": "tight"},
        drive_unit="kV",
    )
