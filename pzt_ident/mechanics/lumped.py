"""One mass, damper and spring."""

from math import pi, sqrt

from pzt_ident.mechanics._oscillator import Oscillator
from pzt_ident.model.bristles import PLAY, bend_and_slide, rub, slide, stretched
from pzt_ident.model.cubic_spring import SOFTEST, beside_spring, cubic_root
from pzt_ident.model.first_order_hold import mode, oscillate
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

BRISTLES = "friction.motion", "friction.elastoplastic"
BUILT_UP = *BRISTLES, "friction.slip"
RUBBING = *BUILT_UP, "friction.coulomb_motion"


@blocks.register
class Lumped(Oscillator):
    """m x'' + b x' + k x = k f, solved exactly for f linear on each step (first-order hold), at rest at the start.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 2.
    """

    mass = Parameter("kg", (0.01, 10), "Moving mass, m.", scale="log")
    damping = Parameter("N*s/m", (0, 1e4), "Viscous damping, b.")
    stiffness = Parameter("N/m", (1e4, 1e9), "Stiffness of flexure and actuator together, k.", scale="log")
    load = Parameter(
        "kg", (0, 10), "Mass of a payload, added to the moving mass.", null=0, effect="load_mass", adds_to="mass"
    )
    extra_damping = Parameter(
        "N*s/m", (0, 3e4), "Added to the damping.", null=0, effect="viscous_damping", adds_to="damping"
    )
    cubic = Parameter(
        "1/response^2", (-0.4, 2), "Cubic over linear stiffness, k3 / k.", null=0, effect="cubic_stiffness"
    )
    friction = Parameter("response", (0, 0.1), "Sliding friction over the stiffness.", null=0, effect=RUBBING)
    reach = Parameter(
        "response",
        (1e-3, 0.5),
        "Displacement over which friction builds up.",
        scale="log",
        effect=BUILT_UP,
        limit=PLAY,
        small_to="friction",
    )
    stiction = Parameter(
        "1", (0, 0.5), "Excess of the break-away force, as a share of friction.", null=0, effect=BRISTLES
    )
    stribeck = Parameter(
        "response/s", (1e-3, 100), "Speed at which stiction has faded.", scale="log", effect=BRISTLES, end="both"
    )
    speed = Parameter(
        "response/s",
        (1e-3, 100),
        "Speed over which Coulomb friction builds up.",
        scale="log",
        effect="friction.coulomb_motion",
    )
    spacing = Parameter(
        "1",
        (0.1, 1),
        "Reach of each element over that of the next, the last of which has all; 1 where all slip at once.",
        scale="log",
        effect="friction.slip",
        end="upper",
    )
    elastic = Parameter(
        "1", (0, 0.95), "Share of the friction up to which bristles only bend.", effect="friction.elastoplastic"
    )

    begun = Parameter(
        "response", (-1, 1), "Displacement from that at rest as a record begins.", 0, effect="history", per_record=True
    )
    swing = Parameter(
        "response", (-1, 1), "Speed then, over the natural frequency.", 0, effect="history", per_record=True
    )

    def prepare(mass, damping, stiffness, load, extra_damping, dt):
        return mode(mass + load, damping + extra_damping, stiffness, dt)

    def at_mode(frequency, damping, stiffness):
        """The oscillator of a natural frequency and a damping ratio: m = k / w^2, b = 2 zeta k / w."""
        pace = 2 * pi * frequency
        return {"mass": stiffness / pace**2, "damping": 2 * damping * stiffness / pace, "stiffness": stiffness}


class Stiffening(Lumped):
    """m x'' + b x' + k (x + c x^3) = k f: the linear oscillator with the input f - c x^3, linear between samples.

    A step is implicit in x: x + (1 + b1) c x^3 = p. A softening spring is linear beyond c x^2 = -SOFTEST.
    """

    def prepare(mass, damping, stiffness, load, extra_damping, cubic, dt):
        return cubic, *mode(mass + load, damping + extra_damping, stiffness, dt)

    def start(u, cubic, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, cubic_root(u, cubic, 1.0)

    def step(w, v, f, u, cubic, r11, r12, r21, r22, b1, b2):
        x = cubic_root(u + r11 * w + r12 * v + b1 * (u - f), cubic, 1 + b1)
        now = u - x * max(cubic * x * x, -SOFTEST)
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, now + w


class Rubbing(Lumped):
    """m x'' + b x' + k (x + F) = k f: the linear oscillator with the input f - F, linear between samples.

    A step is implicit in x: x + (1 + b1) F(x) = p, F by the law of LuGre.
    """

    def prepare(mass, damping, stiffness, load, extra_damping, friction, reach, stiction, stribeck, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return friction, reach, stiction, 1 / (stribeck * dt), *linear

    def start(u, force, reach, stiction, fast, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u, 0.0

    def step(w, v, f, held, u, force, reach, stiction, fast, r11, r12, r21, r22, b1, b2):
        x = u + r11 * w + r12 * v + b1 * (u - f) - (1 + b1) * held
        friction = rub(held, x - f - w, force, reach, stiction, fast, 1 + b1)
        now = u - friction
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, friction, now + w


class RubbingAndStiffening(Rubbing):
    """The same under a spring that stiffens: the input is f - c x^3 - F, and the cubic spring enters a step of friction
    as its chord from x to where x would be if F stayed as it was.
    """

    def prepare(mass, damping, stiffness, load, extra_damping, cubic, friction, reach, stiction, stribeck, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return cubic, friction, reach, stiction, 1 / (stribeck * dt), *linear

    def start(u, cubic, force, reach, stiction, fast, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, cubic_root(u, cubic, 1.0), 0.0

    def step(w, v, f, held, u, cubic, force, reach, stiction, fast, r11, r12, r21, r22, b1, b2):
        before = f + w
        x = cubic_root(u + r11 * w + r12 * v + b1 * (u - f) - (1 + b1) * held, cubic, 1 + b1)
        share = beside_spring(x, before, cubic, 1 + b1)
        friction = rub(held, x - before, force, reach, stiction, fast, share)
        x = x - share * (friction - held)
        now = u - x * max(cubic * x * x, -SOFTEST) - friction
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, friction, now + w


class BendingAndSliding(Lumped):
    """m x'' + b x' + k (x + F) = k f, likewise, F of bristles that only bend at first."""

    def prepare(mass, damping, stiffness, load, extra_damping, friction, reach, stiction, stribeck, elastic, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return friction, reach, stiction, elastic, 1 / (stribeck * dt), *linear

    def start(u, force, reach, stiction, elastic, fast, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u, 0.0

    def step(w, v, f, held, u, force, reach, stiction, elastic, fast, r11, r12, r21, r22, b1, b2):
        x = u + r11 * w + r12 * v + b1 * (u - f) - (1 + b1) * held
        friction = bend_and_slide(held, x - f - w, force, reach, stiction, elastic, fast, 1 + b1)
        now = u - friction
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, friction, now + w


class BendingSlidingAndStiffening(BendingAndSliding):
    """The same under a spring that stiffens, which enters a step of friction as its chord."""

    def prepare(mass, damping, stiffness, load, extra_damping, cubic, friction, reach, stiction, stribeck, elastic, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return cubic, friction, reach, stiction, elastic, 1 / (stribeck * dt), *linear

    def start(u, cubic, force, reach, stiction, elastic, fast, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, cubic_root(u, cubic, 1.0), 0.0

    def step(w, v, f, held, u, cubic, force, reach, stiction, elastic, fast, r11, r12, r21, r22, b1, b2):
        before = f + w
        x = cubic_root(u + r11 * w + r12 * v + b1 * (u - f) - (1 + b1) * held, cubic, 1 + b1)
        share = beside_spring(x, before, cubic, 1 + b1)
        friction = bend_and_slide(held, x - before, force, reach, stiction, elastic, fast, share)
        x = x - share * (friction - held)
        now = u - x * max(cubic * x * x, -SOFTEST) - friction
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, friction, now + w


class Sliding(Lumped):
    """m x'' + b x' + k (x + friction tanh(x' / speed)) = k f, likewise implicit in x' = v omega, which is linear in the
    friction.
    """

    def prepare(mass, damping, stiffness, load, extra_damping, friction, speed, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return friction, sqrt(stiffness / (mass + load)) / speed, *linear

    def start(u, dry, fast, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u

    def step(w, v, f, u, dry, fast, r11, r12, r21, r22, b1, b2):
        now = u - dry * slide(b2 * dry * fast, fast * (r21 * w + r22 * v + b2 * (u - f)))
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, now + w


class SlidingAndStiffening(Sliding):
    """The same under a spring that stiffens, which enters v at the x that friction as it was leads to."""

    def prepare(mass, damping, stiffness, load, extra_damping, cubic, friction, speed, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return cubic, friction, sqrt(stiffness / (mass + load)) / speed, *linear

    def start(u, cubic, dry, fast, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, cubic_root(u, cubic, 1.0), 0.0

    def step(w, v, f, held, u, cubic, dry, fast, r11, r12, r21, r22, b1, b2):
        free = u + r11 * w + r12 * v + b1 * (u - f)
        x = cubic_root(free - (1 + b1) * held, cubic, 1 + b1)
        push = u - x * max(cubic * x * x, -SOFTEST) - f
        friction = dry * slide(b2 * dry * fast, fast * (r21 * w + r22 * v + b2 * push))
        x = cubic_root(free - (1 + b1) * friction, cubic, 1 + b1)
        now = u - x * max(cubic * x * x, -SOFTEST) - friction
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, friction, now + w


class Slipping(Lumped):
    """m x'' + b x' + k (x + F) = k f, likewise implicit in x, F the sum of four elements that stretch and slip:
    dF_i/dx = (friction / 4) / r_i while |F_i| < friction / 4, r_i = reach spacing^(4 - i).
    """

    def prepare(mass, damping, stiffness, load, extra_damping, friction, reach, spacing, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return *elements(friction / 4, reach, spacing), *linear

    def start(u, most, ka, kb, kc, kd, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u, 0.0, 0.0, 0.0, 0.0

    def step(w, v, f, a, b, c, d, u, most, ka, kb, kc, kd, r11, r12, r21, r22, b1, b2):
        x = u + r11 * w + r12 * v + b1 * (u - f) - (1 + b1) * (a + b + c + d)
        a, b, c, d = stretched(x - f - w, a, b, c, d, ka, kb, kc, kd, most, 1 + b1)
        now = u - (a + b + c + d)
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, a, b, c, d, now + w


class SlippingAndStiffening(Slipping):
    """The same under a spring that stiffens, which enters a step of friction as its chord."""

    def prepare(mass, damping, stiffness, load, extra_damping, cubic, friction, reach, spacing, dt):
        linear = mode(mass + load, damping + extra_damping, stiffness, dt)
        return cubic, *elements(friction / 4, reach, spacing), *linear

    def start(u, cubic, most, ka, kb, kc, kd, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, cubic_root(u, cubic, 1.0), 0.0, 0.0, 0.0, 0.0

    def step(w, v, f, a, b, c, d, u, cubic, most, ka, kb, kc, kd, r11, r12, r21, r22, b1, b2):
        before, held = f + w, a + b + c + d
        x = cubic_root(u + r11 * w + r12 * v + b1 * (u - f) - (1 + b1) * held, cubic, 1 + b1)
        share = beside_spring(x, before, cubic, 1 + b1)
        a, b, c, d = stretched(x - before, a, b, c, d, ka, kb, kc, kd, most, share)
        friction = a + b + c + d
        x = x - share * (friction - held)
        now = u - x * max(cubic * x * x, -SOFTEST) - friction
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, a, b, c, d, now + w


def elements(most, reach, spacing):
    """The force at which each of four elements slips, and their stiffnesses."""
    stiff, near, nearer = most / reach, 1 / spacing, 1 / spacing**2
    return most, stiff * near * nearer, stiff * nearer, stiff * near, stiff


class Moving(Lumped):
    """m x'' + b x' + k x = k f, under way as a record begins: x(0) = f(0) + begun, x'(0) = omega swing."""

    def prepare(mass, damping, stiffness, load, extra_damping, begun, swing, dt):
        return begun, swing, *mode(mass + load, damping + extra_damping, stiffness, dt)

    def start(u, begun, swing, r11, r12, r21, r22, b1, b2):
        return begun, swing, u

    def step(w, v, f, u, begun, swing, r11, r12, r21, r22, b1, b2):
        w, v = oscillate(w, v, u - f, r11, r12, r21, r22, b1, b2)
        return w, v, u, u + w


Rubbing.joint = {"cubic_stiffness": RubbingAndStiffening}
BendingAndSliding.joint = {"cubic_stiffness": BendingSlidingAndStiffening}
Sliding.joint = {"cubic_stiffness": SlidingAndStiffening}
Slipping.joint = {"cubic_stiffness": SlippingAndStiffening}
Lumped.forms = {
    "friction.motion": Rubbing,
    "friction.coulomb_motion": Sliding,
    "friction.slip": Slipping,
    "friction.elastoplastic": BendingAndSliding,
    "cubic_stiffness": Stiffening,
    "history": Moving,
}
