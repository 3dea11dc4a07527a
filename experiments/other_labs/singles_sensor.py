"""One effect: of the sensor and the room."""

import numpy as np
from scipy.signal import bessel

from .campaign import LEAST_SQUARES, SMALL_PSO, Campaign, declare, identify, validate
from .drives import Drive
from .dynamics import late, linear
from .hysteresis import two_groups


@declare("n13", "single", sensor_lag=["amplifier_lag", "delay"])
def bessel_filter():
    """Low-pass of third order after Bessel (Thomson 1949) with -3 dB at 2.2 kHz on the reading. The upper bound of the
    gain is 5 % below the truth."""
    rng = np.random.default_rng(13)
    numerator, denominator = bessel(3, 2 * np.pi * 2200, "low", analog=True, norm="mag")

    def drive():
        return Drive(50000).rest(0.02)

    return Campaign(
        title="Scanner 4.8 kHz with the capacitive sensor's filter on",
        mechanics="lumped",
        records=[
            identify("chirp", drive().ramp(40, 0.02).chirp(100, 9000, 0.25, 4).rest(0.02)),
            identify("tri", drive().triangles(30, 90, 4).triangles(80, 60, 7).rest(0.02)),
            identify("step", drive().stairs([20, 60, 50, 80], 0.05)),
            validate("noise", drive().ramp(50, 0.02).noise(5, 2000, 40, 0.24, rng).rest(0.02)),
        ],
        hidden={"reading": lambda x, at: linear([numerator[-1]], list(denominator), x, at.step)},
        parameters={
            "x": {
                "gain": 0.1,
                "alpha": 0.35,
                "beta": 0.021,
                "gamma": 0.02,
                "mass": 0.02,
                "damping": 14.0,
                "stiffness": 1.82e7,
            }
        },
        bounds={"gain": "low", "alpha": [0, 1], "mass": "fix", "stiffness": "tight", "damping": [2, 200]},
        model="[bouc_wen, lumped]",
        steps=4,
    )


@declare("n22", "single", periodic_disturbance=[])
def mains_hum():
    """y gains 21 nm sin(2 pi 49.97 Hz t + phase) and 6.3 nm of its third harmonic, phase and some of the amplitude new
    in each record (mains hum); free-energy hysteresis."""
    hums = [(0.021, 0.3), (0.023, 2.1), (0.02, 4.0), (0.022, 5.5)]
    frequency = 49.97

    def reading(x, at):
        (size, phase), t = hums[at.number], at.times
        third = 0.3 * size * np.sin(6 * np.pi * frequency * t + 3 * phase + 0.8)
        return x + size * np.sin(2 * np.pi * frequency * t + phase) + third

    def drive(rest=0.2):
        return Drive(2000, -30).rest(rest)

    return Campaign(
        title="Stack actuator with strain gauge bridge, long cables",
        base="homogenized_energy",
        records=[
            identify("loop150", drive(0.3).loops(2, 150, 3).rest(0.2)),
            identify("loops_small", drive().loops(4, 60, 3).ramp(40, 0.2).loops(4, 60, 3).rest(0.2)),
            identify("fast", drive().loops(11, 120, 9).rest(0.2)),
            validate("check", drive().reversals([90, 0, 110, 30, 60, -20], 200).rest(0.3)),
        ],
        hidden={"reading": reading},
        parameters={"x": {"gain": 0.055, "remanence": 95.0, "coercive": 38.0, "spread": 0.7, "interaction": 70.0}},
        bounds={
            "gain": "wide",
            "remanence": "wide",
            "coercive": [5, 150],
            "spread": [0.2, 1.5],
            "interaction": [20, 300],
        },
        model="[homogenized_energy]",
        format="dat",
        timed=False,
        optimizers=(SMALL_PSO, "least_squares"),
    )


@declare("n27", "single", delay=["amplifier_lag", "sensor_lag"])
def late_bus():
    """y(t - T) with T = 0.575 ms, which is 2.3 samples: a digital sensor over a bus (pure dead time)."""
    rng = np.random.default_rng(27)

    def drive(rest=0.2):
        return Drive(4000, 0).rest(rest)

    tones = [3, 11, 29, 67, 140, 210, 330]
    return Campaign(
        title="Objective scanner, 40 um, digital sensor over a bus",
        mechanics="lumped",
        records=[
            identify("multi_a", drive().ramp(40, 0.2).multisine(tones, 20, 1.5, rng).rest(0.2)),
            identify("tri", drive().triangles(4, 90, 4).triangles(20, 60, 8).rest(0.2)),
            identify("steps", drive(0.1).stairs([25, 70, 45], 0.25).rest(0.1)),
            validate("chirp", drive().ramp(50, 0.2).chirp(2, 400, 1.5, 10).rest(0.2)),
        ],
        hidden={"reading": lambda x, at: late(at.times, x, 2.3 / 4000)},
        parameters={
            "x": {
                "gain": 0.19,
                "alpha": 0.36,
                "beta": 0.03,
                "gamma": 0.01,
                "mass": 0.35,
                "damping": 28.0,
                "stiffness": 6.7e5,
            }
        },
        bounds={"gain": [5e-5, 4e-4], "mass": "fix", "stiffness": "wide", "damping": [0, 300]},
        model="[bouc_wen, lumped]",
        steps=5,
        format="npy",
        unit="mm",
    )


@declare("n31", "single", drift=[])
def frame_warming_up():
    """y gains S_r (1 - exp(-t / 46 s)) with S_r = 210, 130, 70 and 100 nm in the four records: a frame that warms up
    (Newton's law of cooling)."""
    sizes = [0.21, 0.13, 0.07, 0.1]

    def drive(rest=2):
        return Drive(200, 0).rest(rest)

    return Campaign(
        title="Z stage on an aluminium plate, switched on in the morning",
        records=[
            identify("warm1", drive(3).triangles(0.4, 90, 6).stairs([30, 60, 45, 20], 5).rest(2)),
            identify("warm2", drive(3).loops(0.8, 60, 14).rest(6).loops(0.8, 95, 8).rest(8)),
            identify("null", drive(40)),
            validate("val", drive().reversals([70, 20, 95, 50, 80, 5, 40, 0], 22).rest(12)),
        ],
        hidden={"reading": lambda x, at: x + sizes[at.number] * -np.expm1(-at.times / 46.0)},
        parameters={"x": {"gain": 0.098, "alpha": 0.42, "beta": 0.03, "gamma": 0.012}},
        bounds={"gain": [50, 200], "alpha": "wide", "beta": "wide", "gamma": [-0.05, 0.1]},
        model="[bouc_wen]",
        memory=0.8,
        coloured=0.3,
        format="tsv",
        unit="nm",
    )


@declare("n44", "single", encoder_cyclic_error=[])
def quadrature_errors():
    """Errors of an encoder of 4 um after Heydemann (1981): gain 0.88, offsets 0.07 and -0.05, quadrature 0.1 rad, about
    60 nm with both harmonics; Preisach hysteresis with two groups of coercive voltages."""
    period, (fields, shares) = 4.0, two_groups(9, 33, 52)

    def reading(x, at):
        angle = 2 * np.pi * x / period + 0.7
        sine, cosine = 0.88 * np.sin(angle + 0.1) + 0.07, np.cos(angle) - 0.05
        error = np.arctan2(sine, cosine) - angle
        error = ((error + np.pi) % (2 * np.pi) - np.pi) * period / 2 / np.pi
        return x + error - error[0]

    def drive(rest):
        return Drive(1000).rest(rest)

    return Campaign(
        title="Stage with an optical encoder, 4 um signal period",
        base="preisach",
        records=[
            identify("slow", drive(0.5).triangles(0.5, 110, 1).rest(0.5)),
            identify("nested", drive(0.3).reversals([100, 30, 80, 40, 110, 10, 60, 0], 150).rest(0.3)),
            validate("scan", drive(0.3).ramp(20, 0.2).triangles(4, 85, 8).rest(0.3)),
            validate("steps", drive(0.2).stairs([15, 45, 75, 100, 60, 30], 0.4).rest(0.2)),
        ],
        hidden={"reading": reading},
        parameters={"x": {"gain": 0.11, "interaction": 50.0, "fields": fields, "weights": 6.0 * shares}},
        model="[{name: homogenized_energy, density: free, nodes: 36}]",
        more={"homogenized_energy.interaction": [10, 300]},
        optimizers=(LEAST_SQUARES,),
        repeats=1,
    )
