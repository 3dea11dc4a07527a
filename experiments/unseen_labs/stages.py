"""Parameters of the stages in um, V, N, s and kg."""

STACK = {"gain": 0.1, "alpha": 0.3, "beta": 0.02, "gamma": -0.006, "mass": 0.32, "damping": 118.0, "stiffness": 1.2e7}
SECOND = STACK | {"gain": 0.092, "alpha": 0.26, "beta": 0.018, "mass": 0.25, "damping": 90.0, "stiffness": 1.5e7}
SCANNER = {"gain": 0.045, "alpha": 0.25, "beta": 0.03, "gamma": 0.01, "mass": 0.03, "damping": 10.7, "stiffness": 2.4e6}
TUBE = SCANNER | {"gain": 0.03, "beta": 0.012, "gamma": 0.003}
LONG = {"gain": 0.7, "alpha": 0.22, "beta": 0.012, "gamma": -0.003, "mass": 0.9, "damping": 110.0, "stiffness": 2.1e6}
BENDER = {"gain": 1.0, "alpha": 0.28, "beta": 0.025, "gamma": 0.004, "mass": 0.025, "damping": 1.04, "stiffness": 1.2e4}
KILOVOLT = {
    "gain": 0.06,
    "alpha": 0.3,
    "beta": 0.003,
    "gamma": -0.0008,
    "mass": 1.5,
    "damping": 346.0,
    "stiffness": 5e7,
}
WEIGHTS = (0.011, 0.008, 0.006, 0.005, 0.004, 0.003, 0.0025, 0.002)
PLAYS = {"gain": 0.06} | {f"weight_{i}": weight for i, weight in enumerate(WEIGHTS, 1)}
FREE_ENERGY = {"gain": 0.055, "remanence": 70.0, "coercive": 22.0, "spread": 0.55, "interaction": 60.0}
DOMAIN_WALLS = {"saturation": 20.0, "width": 160.0, "coupling": 0.12, "pinning": 30.0, "reversible": 0.4}
