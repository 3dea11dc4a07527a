"""The standard Bouc-Wen benchmark: a mass on a hysteretic spring."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class BoucWenOscillator(Block):
    """m y'' + c y' + k y + z = u,  z' = alpha y' - beta |y'| z - gamma y' |z|, from rest.

    Noel & Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity, with nu = 1; beta and gamma here
    are the products beta gamma and beta delta of the benchmark. Fourth-order Runge-Kutta with `oversample` steps per
    sample of the interpolated drive. A record begins at y = 0, where the first drive then pushes.
    """

    place = Place.MECHANICS
    oversample = 20
    mass = Parameter("kg", (0.01, 100), "Moving mass.", scale="log")
    damping = Parameter("N*s/m", (0, 1e3), "Viscous damping.")
    stiffness = Parameter("N/m", (1e2, 1e8), "Linear stiffness; stiffness + alpha is the initial one.", scale="log")
    alpha = Parameter("N/m", (0, 1e6), "Initial stiffness of the hysteretic spring.")
    beta = Parameter("1/response", (-5, 20), "Decay of z per displacement on both branches.")
    gamma = Parameter("1/response", (-20, 20), "Decay of z per displacement, with the sign of z along the motion.")

    def prepare(mass, damping, stiffness, alpha, beta, gamma, dt):
        return 1 / mass, damping, stiffness, alpha, beta, gamma, dt

    def start(u, per_mass, damping, stiffness, alpha, beta, gamma, dt):
        return 0.0, 0.0, 0.0, u, 0.0

    def step(y, v, z, before, started, u, per_mass, damping, stiffness, alpha, beta, gamma, dt):
        dt = started * dt  # no time has passed at the first sample
        half = dt / 2
        middle = (before + u) / 2
        a1, r1 = slope(y, v, z, before, per_mass, damping, stiffness, alpha, beta, gamma)
        v2 = v + half * a1
        a2, r2 = slope(y + half * v, v2, z + half * r1, middle, per_mass, damping, stiffness, alpha, beta, gamma)
        v3 = v + half * a2
        a3, r3 = slope(y + half * v2, v3, z + half * r2, middle, per_mass, damping, stiffness, alpha, beta, gamma)
        v4 = v + dt * a3
        a4, r4 = slope(y + dt * v3, v4, z + dt * r3, u, per_mass, damping, stiffness, alpha, beta, gamma)
        sixth = dt / 6
        y = y + sixth * (v + 2 * v2 + 2 * v3 + v4)
        v = v + sixth * (a1 + 2 * a2 + 2 * a3 + a4)
        z = z + sixth * (r1 + 2 * r2 + 2 * r3 + r4)
        return y, v, z, u, 1.0, y


def slope(y, v, z, u, per_mass, damping, stiffness, alpha, beta, gamma):
    """Acceleration and rate of the hysteretic force."""
    return per_mass * (u - damping * v - stiffness * y - z), alpha * v - beta * abs(v) * z - gamma * v * abs(z)
