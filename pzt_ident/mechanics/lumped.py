"""One mass, damper and spring."""

from math import cos, exp, sin, sqrt

from pzt_ident.block import Block, Place
from pzt_ident.parameter import Parameter
from pzt_ident.registry import blocks


@blocks.register
class Lumped(Block):
    """m x'' + b x' + k x = k f, solved exactly for f linear on each step (first-order hold), at rest at the start.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 2. With w = x - f and v = x'/omega, (w, v) turns by
    R = exp(A T) and is pushed by b (f1 - f0). Valid undamped, over- and critically damped, and beyond Nyquist.
    """

    place = Place.MECHANICS
    mass = Parameter("kg", (0.01, 10), "Moving mass.", scale="log")
    damping = Parameter("N*s/m", (0, 1e4), "Viscous damping.")
    stiffness = Parameter("N/m", (1e5, 1e9), "Stiffness of flexure and actuator together.", scale="log")
    load = Parameter("kg", (0, 1), "Mass of a payload, added to the moving mass.", null=0, effect="load_mass")
    extra_damping = Parameter("N*s/m", (0, 1e3), "Added to the damping.", null=0, effect="viscous_damping")

    def prepare(mass, damping, stiffness, load, extra_damping, dt):
        mass, damping = mass + load, damping + extra_damping
        omega = sqrt(stiffness / mass)
        zeta = damping / (2 * sqrt(stiffness * mass))
        angle = omega * dt
        cosine, sine = rotation(zeta, angle)
        r11, r12 = cosine + zeta * sine, sine
        r21, r22 = -sine, cosine - zeta * sine
        lag, speed = 2 * zeta / angle, 1 / angle
        return r11, r12, r21, r22, r11 * lag - r12 * speed - lag, r21 * lag - r22 * speed + speed

    def start(u, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u

    def step(w, v, f, u, r11, r12, r21, r22, b1, b2):
        push = u - f
        w, v = r11 * w + r12 * v + b1 * push, r21 * w + r22 * v + b2 * push
        return w, v, u, u + w


def rotation(zeta, angle):
    """exp(-zeta a) cos(s a) and exp(-zeta a) sin(s a) / s with s = sqrt(1 - zeta^2), real for every zeta >= 0."""
    square = (1 - zeta) * (1 + zeta) * angle**2
    x, decay = sqrt(abs(square)), exp(-zeta * angle)
    if x < 1e-2:
        series = 1 - square / 6 * (1 - square / 20 * (1 - square / 42))
        return decay * (1 - square / 2 * (1 - square / 12 * (1 - square / 30))), decay * angle * series
    if zeta < 1:
        return decay * cos(x), decay * angle * sin(x) / x
    slow, fast = exp(-(angle**2) / (x + zeta * angle)), exp(-x - zeta * angle)
    return (slow + fast) / 2, angle * (slow - fast) / (2 * x)
