"""Parameter sets for the models of Smith and co-workers. Those of the homogenized energy model were never printed: set
A reproduces the axes of their figures 3 and 10 (displacement from -5.5e-5 to 4.6e-5 m, loop width 15 %)."""

ETA, REMANENCE = 1.09e8, 8.79e-5  # V m / C and C/m^2, scaled so that the displacement is P - P_R
A = {
    "homogenized_energy.gain": 1 / ETA,
    "homogenized_energy.remanence": ETA * REMANENCE,
    "homogenized_energy.coercive": 2400.0,
    "homogenized_energy.spread": 0.887,
    "homogenized_energy.interaction": 6120.0,
    "homogenized_energy.quadratic": 0.0,
    "homogenized_energy.poled": 1e6,
    "homogenized_energy.bias": 0.0,
}
LUMPED = {"lumped.mass": 4.21, "lumped.damping": 1.52e5, "lumped.stiffness": 8.75e7}
"""Table 1, the row of the lumped model as printed."""

T_ETA, T_REMANENCE = 1.071e8, 9.39e-5
T = {
    "thermal_homogenized_energy.gain": 1 / T_ETA,
    "thermal_homogenized_energy.remanence": T_ETA * T_REMANENCE,
    "thermal_homogenized_energy.coercive": 3290.0,
    "thermal_homogenized_energy.spread": 0.887,
    "thermal_homogenized_energy.interaction": 6120.0,
    "thermal_homogenized_energy.thermal": 0.02,
    "thermal_homogenized_energy.dwell": 1e-3,
    "thermal_homogenized_energy.quadratic": 0.0,
    "thermal_homogenized_energy.poled": 1e6,
    "thermal_homogenized_energy.bias": 0.0,
}
"""With thermal activation; the width of its loops follows figure 11."""

STRAIN = 3.52e-2 * 0.02  # beta l, m^3 / C


def domain_wall(alpha, k, c, a=4.6e5, p_s=0.49):
    """Parameters of the block from those of the paper: V m / C, V / m, 1, V / m, C / m^2."""
    values = {"saturation": STRAIN * p_s, "width": a, "coupling": alpha * p_s / a, "pinning": k, "reversible": c}
    return {f"domain_wall.{word}": value for word, value in values.items()}


PRINTED = {"alpha": 4.5e6, "k": 1.4e5, "c": 0.81}
DW1, DW2 = {"alpha": 4.5e5, "k": 1.47e4, "c": 0.643}, {"alpha": 2.0e5, "k": 5.01e3, "c": 0.744}
"""alpha and k a decade below the print: the printed set runs away."""
