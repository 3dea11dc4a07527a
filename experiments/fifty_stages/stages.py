"""The 50 stages: what acts in each, how it is driven, sampled and disturbed. Sizes are where scaling starts from."""

from collections import namedtuple

import numpy as np

# share: of the largest voltage; other: drive of the second axis (kind, frequency)
Run = namedtuple("Run", "kind seconds frequency use share other", defaults=(1.0, None))
IDENTIFY, VALIDATE = "identify", "validate"


def _runs(*given):
    return [Run(*run) for run in given]


def _decades(first, last, count):
    return list(np.geomspace(first, last, count))


I, V = IDENTIFY, VALIDATE  # noqa: E741
LOOPS = _runs(("tri", 4, 1, I), ("nest", 5, 1, I), ("tri", 3, 2, I, 0.6), ("rand", 5, 3, V), ("tridec", 6, 0.8, V))
HOLDS = _runs(
    ("steps", 25, 0.3, I), ("tri", 15, 0.2, I), ("nest", 20, 1, I), ("steps", 20, 0.4, V), ("tri", 10, 0.4, V, 0.7)
)
SINES = _runs(
    ("tri", 2, 1, I),
    ("sine", 1, 8, I, 0.8),
    ("sine", 0.4, 40, I, 0.6),
    ("sine", 0.2, 120, I, 0.3),
    ("rand", 1, 25, V, 0.7),
    ("sine", 0.3, 70, V, 0.5),
)
RATES = _runs(
    ("tri", 4, 0.5, I),
    ("sine", 1.5, 4, I),
    ("sine", 0.5, 30, I),
    ("sine", 0.3, 100, I, 0.9),
    ("nest", 2, 1, V),
    ("rand", 2, 20, V),
)


def _dynamic(f1, seconds=0.5):
    """A loop, two chirps, tones and random motion about a resonance."""
    band = (0.04 * f1, 1.5 * f1)
    return _runs(
        ("tri", seconds, 4 / seconds, I),
        ("chirplo", seconds, band, I),
        ("chirphi", seconds, band, I),
        ("ms", seconds, (0.02 * f1, 1.3 * f1), V),
        ("rand", seconds, 0.15 * f1, V),
    )


def _two(f1, seconds):
    """Each axis alone, then both."""
    band = (0.04 * f1, 1.9 * f1)
    return _runs(
        ("tri", seconds, 4 / seconds, I, 1, ("zero", 0)),
        ("zero", seconds, 0, I, 1, ("tri", 4 / seconds)),
        ("hold", seconds, 0, I, 0.4, ("chirp", band)),
        ("chirp", seconds, band, I, 0.8, ("sine", 6 / seconds)),
        ("ms", seconds, (0.02 * f1, 1.3 * f1), V, 1, ("ms", (0.03 * f1, 1.7 * f1))),
        ("tri", seconds, 6 / seconds, V, 0.7, ("rand", 0.05 * f1)),
    )


def _effect(effect, words, size, span=(0.4, 2.2), **rest):
    """span: how far the size may be scaled."""
    return {"effect": effect, "words": words, "span": span, "acts": {"size": size, **rest}}


STAGES = {}


def _stage(name, kind, rate, base, records, *effects, **rest):
    """rest: fine, resonance, damping, two, fixed, voltage, noise, sigma (nm), bounds, wrong_mass, also_right."""
    STAGES[name] = {"kind": kind, "rate": rate, "base": base, "records": records, "effects": list(effects), **rest}


BOUC_WEN, PLAYS, FREE_ENERGY = "bouc_wen", "prandtl_ishlinskii", "homogenized_energy"
WIDE_TIMES = _decades(3e-3, 1e3, 24)
FRACTIONAL = {"shares": [time**0.15 for time in WIDE_TIMES], "times": WIDE_TIMES}
LOGARITHMIC = {"shares": [1.0] * 11, "times": _decades(0.01, 1000, 11)}

_stage(
    "s01_anna", "single", 1000, BOUC_WEN, LOOPS,
    _effect(
        "asymmetry", "h decays faster on rising than on falling branches, beta (1 + e sgn dU)", 0.25, by="branch"
    ),
)  # fmt: skip
_stage(
    "s02_bodo", "single", 20000, BOUC_WEN, _dynamic(900, 0.4),
    _effect(
        "cubic_stiffness", "hardening spring k (x + a x^2 + c x^3), a = 2e-4/um", 2e-4, quadratic=2e-4
    ),
    fine=5, resonance=900,
)  # fmt: skip
_stage(
    "s03_cora", "single", 4000, BOUC_WEN,
    _runs(("nest", 2, 1, I), ("tri", 1.5, 2, I), ("sine", 1, 6, I, 0.3), ("steps", 2, 5, V), ("rand", 2, 8, V)),
    _effect("friction", "four Maxwell-slip elements in the equation of motion", 0.12, law="slip", reach=0.3),
    resonance=300, damping=0.03,
)  # fmt: skip
_stage(
    "s04_dirk", "single", 10000, BOUC_WEN, _dynamic(700, 0.6),
    _effect("load_mass", "payload on a stage whose mass and stiffness are known", 0.12),
    resonance=700, fixed=("mass", "stiffness"),
)  # fmt: skip
_stage(
    "s05_elsa", "single", 2500, PLAYS, RATES,
    _effect("rate_dependence", "half-widths grow with the rate, r (1 + a ln(1 + |dU/dt| / 50 V/s))", 0.03, speed=50.0),
)  # fmt: skip
_stage(
    "s06_falk", "single", 500, BOUC_WEN, HOLDS,
    _effect("thermal_relaxation", "activated decay dh/dt = -(s / tau) sinh(h / s), s = 4 V", 0.03, scale=4.0),
)  # fmt: skip
_stage(
    "s07_gabi", "single", 10000, PLAYS, _dynamic(500, 0.6),
    _effect("viscous_damping", "eddy-current damper whose gap grows, b v / (1 + x / 80 um)", 0.03, gap=80.0),
    resonance=500, damping=0.012, fixed=("damping",),
)  # fmt: skip
_stage(
    "s08_hugo", "single", 10000, BOUC_WEN,
    _runs(
        ("tri", 0.8, 5, I), ("sine", 0.4, 40, I, 0.8), ("sine", 0.2, 160, I, 0.5), ("chirp", 0.6, (20, 1500), I),
        ("rand", 0.6, 120, V), ("sine", 0.3, 90, V, 0.6),
    ),
    _effect("amplifier_lag", "critically damped amplifier of second order", 1.6e-4, poles=2),
    also_right={"amplifier_lag": ["delay", "sensor_lag"]},
)  # fmt: skip
_stage(
    "s09_ines", "single", 1000, PLAYS,
    _runs(
        ("sine", 3, 1, I, 1), ("sine", 3, 1, I, 0.65), ("tri", 3, 2, I, 0.35), ("sine", 2, 2, I, 0.15),
        ("nest", 3, 1, V, 0.8), ("rand", 4, 3, V, 0.5),
    ),
    _effect("amplitude_gain", "gain grows with the range of the record, 1 + k (Upp / 100 V)^0.8", 0.03, power=0.8),
)  # fmt: skip
_stage(
    "s10_jens", "single", 500, BOUC_WEN, HOLDS,
    _effect("creep", "fractional, ~ t^0.15 from 3 ms to 1000 s", 0.004, **FRACTIONAL),
)  # fmt: skip
_stage(
    "s11_karl", "single", 16000, BOUC_WEN, _two(700, 0.4),
    _effect("cross_coupling", "spring between the tables, k (x - y) in both equations of motion", 0.03, by="spring"),
    fine=6, resonance=700, two=True,
)  # fmt: skip
_stage(
    "s12_lena", "single", 5000, PLAYS, SINES,
    _effect("delay", "reading late by a fraction of samples", 5.2e-4, of="reading"),
)  # fmt: skip
_stage(
    "s13_mona", "single", 1000, BOUC_WEN,
    _runs(
        ("nest", 5, 1, I), ("tridec", 5, 1, I), ("bip", 3, 1, I, 0.5), ("tri", 3, 1, I), ("rand", 6, 3, V),
        ("nest", 5, 1, V, 0.7),
    ),
    _effect(
        "distributed_memory", "twelve plays of equal weight, half-widths of 3 to 45 V in geometric steps", 0.08,
        weights=[1.0] * 12, widths=_decades(3, 45, 12),
    ),
)  # fmt: skip
_stage(
    "s14_nils", "single", 500, FREE_ENERGY,
    _runs(
        ("tri", 10, 0.3, I), ("hold", 10, 0, I, 0.5), ("nest", 15, 1, I), ("steps", 15, 0.5, V),
        ("tri", 10, 0.5, V, 0.6),
    ),
    _effect("drift", "frame warms up over the campaign, 1 - exp(-t / 70 s)", 0.6, time=70.0),
    fine=2,
)  # fmt: skip
_stage(
    "s15_olga", "single", 2000, BOUC_WEN,
    _runs(("tri", 2, 1, I), ("sine", 2, 2, I), ("nest", 3, 1, I), ("rand", 3, 3, V), ("tridec", 3, 2, V)),
    _effect(
        "encoder_cyclic_error", "period 4 um, second harmonic 0.4", 0.03,
        period=4.0, phase=0.8, second=0.4, second_phase=2.0,
    ),
)  # fmt: skip
_stage(
    "s16_paul", "single", 16000, BOUC_WEN, _two(600, 0.4),
    _effect("kinematic_coupling", "sensor turned: x + e y is read, and y - 0.01 x", 0.012, back=-0.01),
    fine=6, resonance=600, two=True,
)  # fmt: skip
_stage(
    "s17_rosa", "single", 2000, FREE_ENERGY,
    _runs(("tri", 3, 1, I), ("hold", 2, 0, I, 0.3), ("nest", 3, 1, I), ("rand", 3, 3, V), ("sine", 3, 2, V)),
    _effect(
        "periodic_disturbance", "hum of 50 Hz with harmonics 0.3 and 0.2, other phases each record", 0.12,
        frequency=50.02, harmonics=[1, 0.3, 0.2, 0],
    ),
    fine=2,
)  # fmt: skip
_stage(
    "s18_sven", "single", 1000, PLAYS,
    _runs(("tri", 4, 1, I), ("nest", 4, 1, I), ("bip", 4, 1, I, 0.4), ("rand", 4, 3, V), ("tri", 4, 2, V, 0.6)),
    _effect("quadratic_gain", "electrostriction, q U^2 ahead of all that is linear", 4e-4),
)  # fmt: skip
_stage(
    "s19_tina", "single", 20000, BOUC_WEN,
    [
        *_dynamic(600, 0.4)[:1],
        *_runs(
            ("chirp", 0.5, (30, 3000), I), ("chirphi", 0.5, (30, 3000), I), ("ms", 0.5, (20, 2400), V),
            ("rand", 0.4, 90, V),
        ),
    ],
    _effect(
        "resonance", "mirror on a spring of its own, 1450 Hz, carried by the table", 0.02,
        place="rider", frequency=1450.0, damping=0.01,
    ),
    fine=6, resonance=600,
)  # fmt: skip
_stage(
    "s20_udo", "single", 1000, BOUC_WEN,
    _runs(("tri", 4, 1, I), ("bip", 4, 1, I, 0.9), ("nest", 4, 1, I), ("rand", 5, 3, V), ("bip", 4, 2, V, 0.6)),
    _effect("saturation", "Langevin's function of the response", 1 / 60.0, law="langevin"),
)  # fmt: skip
_stage(
    "s21_vera", "single", 20000, BOUC_WEN, _dynamic(900, 0.4),
    _effect("sensor_lag", "Butterworth filter of three poles", 5e-5, poles=3),
    fine=5, resonance=900, also_right={"sensor_lag": ["delay"]},
)  # fmt: skip
_stage(
    "s22_willi", "single", 5000, BOUC_WEN,
    _runs(
        ("tri", 2, 2, I), ("sine", 0.5, 30, I), ("sine", 0.3, 70, I, 0.9), ("sine", 0.2, 140, I, 0.6),
        ("rand", 1, 30, V), ("sine", 0.3, 50, V),
    ),
    _effect("slew_limit", "largest current of the amplifier", 1 / 1.2e4, (0.4, 2.5)),
)  # fmt: skip
_stage(
    "s23_xenia", "single", 3000, PLAYS,
    _runs(
        ("nest", 2.5, 1, I), ("tri", 2, 1.5, I), ("sine", 1.5, 5, I, 0.3), ("tri", 2, 3, V, 0.6), ("rand", 2.5, 6, V)
    ),
    _effect(
        "friction", "LuGre bristles in the equation of motion, stiction 25 %", 0.15,
        law="lugre", reach=0.3, stiction=0.25, speed=30.0, inner=1e-5,
    ),
    resonance=220, damping=0.04,
)  # fmt: skip
_stage(
    "s24_york", "single", 1000, BOUC_WEN,
    _runs(
        ("steps", 15, 0.5, I), ("tri", 8, 0.5, I), ("chirp", 2, (3, 250), I), ("steps", 10, 0.7, V), ("rand", 6, 4, V)
    ),
    _effect("creep", "logarithm of time from 10 ms to 1000 s", 0.004, **LOGARITHMIC),
    resonance=120, damping=0.05,
)  # fmt: skip

_stage("n01_ada", "none", 1000, BOUC_WEN, LOOPS, noise="ar1", sigma=8, bounds="tight")
_stage("n02_ben", "none", 20000, BOUC_WEN, _dynamic(1100, 0.4), fine=5, resonance=1100, noise="quant", sigma=12)
_stage("n03_cem", "none", 500, PLAYS, HOLDS, noise="white", sigma=1.5)
_stage("n04_dora", "none", 1000, FREE_ENERGY, LOOPS, fine=2, noise="white", sigma=15, bounds="default")
_stage(
    "n05_egon", "none", 16000, BOUC_WEN, _two(800, 0.4), fine=6, resonance=800, two=True, noise="white", sigma=3
)  # fmt: skip
_stage(
    "n06_fred", "none", 50000, PLAYS, _dynamic(2500, 0.2),
    fine=5, resonance=2500, noise="ar1", sigma=5, wrong_mass=True,
)  # fmt: skip
_stage("n07_gina", "none", 2500, BOUC_WEN, RATES, noise="ar1", sigma=25, bounds="wide")
_stage(
    "n08_hans", "none", 4000, BOUC_WEN,
    _runs(
        ("nest", 2, 1, I), ("tri", 1.5, 2, I), ("sine", 1, 6, I, 0.3), ("chirp", 1, (10, 600), I), ("steps", 2, 5, V),
        ("rand", 2, 8, V),
    ),
    resonance=300, damping=0.03, noise="white", sigma=0.7, bounds="wide", wrong_mass=True,
)  # fmt: skip

_stage(
    "p01_aare", "pair", 500, BOUC_WEN, HOLDS,
    _effect("creep", "Maxwell elements of 0.4, 2.5 and 30 s", 0.004, shares=[1.0, 2.0, 3.0], times=[0.4, 2.5, 30.0]),
    _effect("quadratic_gain", "q U^2", 2e-4),
)  # fmt: skip
_stage(
    "p02_bode", "pair", 16000, BOUC_WEN,
    _runs(
        ("tri", 0.6, 8, I), ("chirp", 0.6, (20, 2500), I), ("sine", 0.3, 60, I, 0.5), ("chirphi", 0.5, (20, 2500), V),
        ("rand", 0.6, 70, V),
    ),
    _effect("amplifier_lag", "amplifier of first order", 6e-5, poles=1),
    _effect(
        "resonance", "second mode in parallel, 1300 Hz, damping 0.012", 0.03,
        place="parallel", frequency=1300.0, damping=0.012,
    ),
    fine=6, resonance=500, also_right={"amplifier_lag": ["sensor_lag"]},
)  # fmt: skip
_stage(
    "p03_elbe", "pair", 1500, BOUC_WEN,
    _runs(
        ("nest", 6, 1, I), ("steps", 10, 0.6, I), ("tri", 5, 1, I, 0.5), ("steps", 8, 0.6, V), ("rand", 5, 5, V)
    ),
    _effect("friction", "Dahl's in the equation of motion", 0.12, law="dahl", reach=0.25),
    _effect("creep", "fractional, t^0.15", 0.004, **FRACTIONAL),
    resonance=200, damping=0.04,
)  # fmt: skip
_stage(
    "p04_glan", "pair", 500, PLAYS,
    _runs(
        ("tri", 10, 0.3, I), ("bip", 10, 0.3, I, 0.9), ("nest", 12, 1, I), ("hold", 8, 0, I, 0.5), ("rand", 12, 2, V),
        ("bip", 8, 0.5, V, 0.7),
    ),
    _effect("saturation", "arctan of the response", 1 / 60.0, law="arctan"),
    _effect("drift", "ramps, another slope each record", 0.02, slopes=[1.0, 1.6, 0.8, 2.2, 1.3, 0.6]),
)  # fmt: skip
_stage(
    "p05_ilm", "pair", 16000, BOUC_WEN, _two(700, 0.4),
    _effect("delay", "both commands late by a fraction of samples", 9e-5, of="command", both=True),
    _effect("cross_coupling", "force of y acts on x ahead of its mechanics", 0.02, by="force"),
    fine=6, resonance=700, two=True,
)  # fmt: skip
_stage(
    "p06_jade", "pair", 10000, BOUC_WEN, [*_runs(("tri", 0.8, 3, I)), *_dynamic(600, 0.6)[1:]],
    _effect(
        "encoder_cyclic_error", "period 3 um, second harmonic 0.5", 0.03,
        period=3.0, phase=2.2, second=0.5, second_phase=0.4,
    ),
    _effect("load_mass", "payload on a stage whose mass and stiffness are known", 0.08),
    resonance=600, fixed=("mass", "stiffness"),
)  # fmt: skip
_stage(
    "p07_kyll", "pair", 2500, BOUC_WEN, RATES,
    _effect("rate_dependence", "beta, gamma over 1 + r log10(1 + |dU/dt| / 20 V/s)", 0.1, speed=20.0),
    _effect(
        "periodic_disturbance", "hum of 60 Hz with a third harmonic, phases by record", 0.03,
        frequency=59.97, harmonics=[1, 0, 0.4, 0],
    ),
)  # fmt: skip
_stage(
    "p08_lahn", "pair", 5000, BOUC_WEN,
    _runs(
        ("nest", 2, 1, I), ("tridec", 2, 2.5, I), ("bip", 0.5, 30, I, 0.5), ("chirp", 0.5, (10, 800), I),
        ("rand", 2, 20, V), ("nest", 1, 1, V, 0.7),
    ),
    _effect(
        "distributed_memory", "ten plays of falling weights, half-widths of 2 to 40 V", 0.05,
        weights=_decades(3, 1, 10), widths=_decades(2, 40, 10),
    ),
    _effect("sensor_lag", "Butterworth filter of two poles", 3e-4, poles=2),
    also_right={"sensor_lag": ["delay"]},
)  # fmt: skip
_stage(
    "p09_main", "pair", 2000, BOUC_WEN,
    _runs(
        ("steps", 8, 1, I), ("tri", 5, 0.6, I), ("sine", 0.6, 40, I), ("sine", 0.4, 90, I, 0.7), ("rand", 3, 15, V),
        ("steps", 6, 1, V),
    ),
    _effect("slew_limit", "largest current of the amplifier", 1 / 1.6e4, (0.8, 1.5)),
    _effect("creep", "logarithm of time from 10 ms to 1000 s", 0.004, **LOGARITHMIC),
    fine=10, voltage=150.0,
)  # fmt: skip
_stage(
    "p10_nahe", "pair", 1000, BOUC_WEN,
    _runs(
        ("tri", 4, 1, I, 1, ("zero", 0)), ("zero", 3, 0, I, 1, ("tri", 1)), ("nest", 4, 1, I, 1, ("rand", 2)),
        ("rand", 5, 3, V, 1, ("nest", 1)), ("tridec", 4, 1, V, 1, ("sine", 0.7)),
    ),
    _effect("asymmetry", "alpha (1 + e U sgn dU)", 1e-3, by="voltage"),
    _effect("kinematic_coupling", "sensor of x turned towards y", 0.01),
    two=True, also_right={"kinematic_coupling": ["cross_coupling"]},
)  # fmt: skip
_stage(
    "p11_oder", "pair", 10000, PLAYS,
    _runs(
        ("tri", 0.8, 5, I), ("tri", 0.6, 6, I, 0.5), ("sine", 0.6, 10, I, 0.2), ("chirp", 0.6, (20, 700), I),
        ("chirphi", 0.6, (20, 700), V), ("rand", 0.6, 60, V, 0.7),
    ),
    _effect("viscous_damping", "oil film, b v", 0.03, gap=1e9),
    _effect("amplitude_gain", "Rayleigh, 1 + k Upp of the record", 0.02, power=1.0),
    resonance=400, damping=0.012, fixed=("damping",),
)  # fmt: skip
_stage(
    "p12_prim", "pair", 500, BOUC_WEN, HOLDS,
    _effect("thermal_relaxation", "linear decay of h", 0.02),
    _effect(
        "periodic_disturbance", "floor at 17.3 Hz with a second harmonic", 0.03,
        frequency=17.3, harmonics=[1, 0.25, 0, 0],
    ),
)  # fmt: skip

_stage(
    "o01_alpha", "outside", 500, BOUC_WEN, HOLDS,
    _effect("gain_warm_up", "gain falls as the stage warms up, 1 + g exp(-t / 40 s)", 0.03, time=40.0),
)  # fmt: skip
_stage(
    "o02_bravo", "outside", 2000, PLAYS,
    _runs(
        ("bip", 2, 1, I), ("tri", 2, 2, I), ("nest", 3, 1, I), ("bip", 2, 3, I, 0.4), ("rand", 3, 3, V),
        ("bip", 2, 2, V, 0.7),
    ),
    _effect("crossover_distortion", "output stage dead about 0 V, U - z tanh(U / 3 V)", 1.0, width=3.0),
)  # fmt: skip
_stage(
    "o03_charlie", "outside", 5000, BOUC_WEN, SINES,
    _effect("clock_skew", "clock of the recorder runs fast, y(t (1 + e))", 4e-4),
)  # fmt: skip
_stage(
    "o04_delta", "outside", 1000, BOUC_WEN, LOOPS,
    _effect("sensor_jumps", "mount of the sensor slips at random times by random steps", 0.1),
)  # fmt: skip
_stage(
    "o05_echo", "outside", 1000, PLAYS, LOOPS,
    _effect("ageing", "gain falls with the voltage travelled, 1 - a (1 - exp(-way / 1500 V))", 0.03, over=1500.0),
)  # fmt: skip
_stage(
    "o06_foxtrot", "outside", 10000, BOUC_WEN, _dynamic(500, 0.6),
    _effect("quadratic_drag", "drag v |v| in the equation of motion", 0.6),
    resonance=500, also_right={"quadratic_drag": ["viscous_damping"]},
)  # fmt: skip
