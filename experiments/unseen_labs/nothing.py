"""No effect beside the base of the job."""

from .campaign import Campaign, alone, declare, identify, validate
from .drives import chirp, multisine, nested, noise, path, stairs
from .stages import BENDER, FREE_ENERGY, LONG, PLAYS, STACK


@declare("a18", "none")
def plain_stack():
    """A plain stack stage: Bouc-Wen ahead of one mass-spring-damper (Lin & Lin 2012). White noise and a 16-bit
    reading."""
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK},
        records=(
            identify("loops", path(1000, [0, 120, 0, 60, 10, 90, 0], 150, 0.4)),
            identify("sweep", chirp(10000, 50, 3, 50, 2500, 0.8, 0.1, 0.05)),
            validate("val", nested(1000, 110, [1, 0.2, 0.7, 0.4, 0.9, 0], 200, 0.4)),
            validate("val_ms", multisine(10000, 60, 8, 40, 1500, 25, 0.5, 31)),
        ),
        noise=0.004,
        bounds={"gain": "edge", "alpha": "tight", "mass": "fix", "damping": "wide", "stiffness": "tight"},
        counts=0.005,
    )


@declare("a19", "none")
def cut_out_of_a_motion():
    """A 100 um stage measured right after conditioning cycles, so that each record begins in motion: 2.3 triangle
    cycles ran before the first sample and went on into the record. Bouc-Wen (Wen 1976) and one mass; sensor noise with
    memory 0.6."""

    def cycled(*ends):
        return path(1000, [0, *ends], 250, 0).ahead()

    return Campaign(
        base="bouc_wen",
        parameters={"x": LONG},
        mechanics=False,
        records=(
            identify("tri", path(1000, [60, 150, 0, 150, 0, 150], 250, 0), ahead=cycled(150, 0, 150, 0, 60)),
            identify("dec", path(1000, [110, 10, 100, 20, 90, 30, 80, 0], 250, 0), ahead=cycled(150, 0, 150, 110)),
            validate("val", path(1000, [45, 130, 20, 140, 60, 90, 0], 180, 0), ahead=cycled(140, 0, 140, 10, 45)),
        ),
        noise=0.012,
        memory=0.6,
        bounds={"gain": "tight", "beta": "wide"},
    )


@declare("a40", "none")
def plain_plays():
    """A plain ceramic of plays (Prandtl-Ishlinskii, Kuhnen 2003) with bounds wide by a factor of five; white noise, 12
    bit reading of 5 nm."""
    return Campaign(
        base="prandtl_ishlinskii",
        parameters={"x": PLAYS},
        mechanics=False,
        known={"reach": 60.0},
        records=(
            identify("tri", path(1000, [0, 120, 0, 60, 20, 120, 0], 120, 0.5)),
            identify("dec", nested(1000, 120, [1, 0.1, 0.9, 0.2, 0.8, 0.3, 0.7, 0.4, 0], 200, 0.5)),
            validate("val", noise(1000, 0, 118, 2, 6, 13)),
        ),
        noise=0.006,
        steps=2,
        counts=0.005,
        bounds=dict.fromkeys(PLAYS, "wide"),
        lines=("prandtl_ishlinskii.reach: {value: 60}",),
        format="parquet",
    )


@declare("a41", "none")
def second_axis_that_does_not_couple():
    """An XY stage of which y is driven and not measured, and does not couple. Bouc-Wen and one mass on x; coloured
    sensor noise (AR 0.8)."""
    raster = path(1000, [0, *[100, 0] * 5], 300, 0.3), path(1000, [0, 90, 0], 50, 0.3)
    both = nested(1000, 115, [1, 0.2, 0.7, 0.4, 0.9, 0], 150, 0.3), path(1000, [0, 100, 20, 80, 0], 100, 0.3)
    return Campaign(
        base="bouc_wen",
        parameters={"x": STACK, "y": STACK},
        records=(
            identify("raster", *raster),
            identify("y_only", *alone(path(1000, [0, 110, 0, 60, 0], 200, 0.3), "y")),
            identify("sweep", *alone(chirp(10000, 50, 3, 50, 2500, 0.6, 0.1, 0.05), "x")),
            validate("val", *both),
        ),
        noise=0.007,
        memory=0.8,
        bounds={"gain": "tight", "alpha": "tight2", "mass": "fix", "damping": "wide", "stiffness": "tight"},
    )


@declare("a42", "none")
def plain_free_energy():
    """A Preisach-like ceramic (homogenized energy, Smith et al.) from rest, 6 nm of noise with memory 0.5; bounds of
    the gain within 20 %, of the rest wide."""
    wide = {"remanence": "wide2", "coercive": "wide", "interaction": "wide2", "spread": (0.2, 1.2)}
    return Campaign(
        base="homogenized_energy",
        parameters={"x": FREE_ENERGY},
        mechanics=False,
        known={"nodes": 256},
        records=(
            identify("tri", path(400, [0, 120, 0, 120, 0, 60, 0], 80, 0.5)),
            identify("nested", nested(400, 120, [1, 0.2, 0.8, 0.4, 0.6, 0], 80, 0.5)),
            validate("val", nested(400, 110, [0.5, 0.1, 1, 0.6, 0.9, 0], 80, 0.5)),
        ),
        noise=0.006,
        memory=0.5,
        steps=1,
        bounds={"gain": "tight"} | wide,
        format="mat73",
    )


@declare("a43", "none")
def bender_after_cycles():
    """A bender of 120 um with a bound on the stiffness that barely holds the truth and wide ones elsewhere; records
    begin in motion after conditioning triangles. Bouc-Wen and one mass at 110 Hz, white noise."""

    def cycled(*ends):
        return path(1000, [0, *ends], 200, 0).ahead()

    return Campaign(
        base="bouc_wen",
        parameters={"x": BENDER},
        records=(
            identify("tri", path(1000, [20, 60, -60, 60, -60, 0], 200, 0), ahead=cycled(60, -60, 60, -60, 20)),
            identify("ms", multisine(4000, 20, 3, 5, 300, 30, 2.0, 17, 0.3, 0.2)),
            validate("val", path(1000, [-15, 40, -50, 30, -20, 55, 0], 150, 0), ahead=cycled(60, -60, 60, -15)),
            validate("val_steps", stairs(2000, [20, -20, 10, 0], 5000, 0.4, 0.2)),
        ),
        noise=0.015,
        steps=10,
        bounds={"gain": "wide", "mass": (0.02, 0.1), "damping": "wide", "stiffness": "edge"},
    )
