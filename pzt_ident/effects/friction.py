"""Dry friction in the guide."""

from dataclasses import replace

from pzt_ident.model.block import Block, Place, Term, expm1
from pzt_ident.model.bristles import PLAY, bend, rub
from pzt_ident.model.first_order_hold import decay
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


class Rubbing:
    """What all forms of friction declare."""

    form = Form(
        "lugre",
        (
            "lugre",
            "lugre_viscous",
            "commanded",
            "commanded_lugre",
            "coulomb",
            "commanded_coulomb",
            "motion",
            "coulomb_motion",
            "slip",
            "elastoplastic",
        ),
        "The law of friction, and where it acts.",
    )
    sizes = (0.02, 0.1, 0.5)
    loops = True
    look_alikes = ("distributed_memory", "delay", "amplifier_lag", "sensor_lag", "viscous_damping")
    separate_by = (
        "Hold the voltage and push the stage by an external force or another axis: only friction has a loop, and a"
        " backlash between stage and sensor, which leaves the same trace: a second sensor does not see that one."
    )
    remedy = (
        "Free cables and guides, lubricate or change the preload, tighten the linkage of the sensor, drive turning"
        " points slower or close the loop."
    )


class Ahead(Rubbing):
    """Friction ahead of the equation of motion, which the force on the mechanics has to overcome."""

    place = Place.GUIDE
    force = Parameter("response", (0, 0.1), "Sliding friction over the stiffness.", null=0)


@blocks.register
class Friction(Ahead, Block):
    """Bristles of the guide bend, then slide (LuGre): x + F = f,  dF/dx = (g - F sgn dx/dt) / (reach g / force),
    g = force (1 + stiction exp(-(v / stribeck)^2)).

    Canudas de Wit, Olsson, Astrom & Lischinsky (1995), IEEE Trans. Autom. Control 40, 419, eq. 2 to 5, without
    viscous friction; without stiction it is the model of Dahl (1976), AIAA J. 14, 1675. F is the friction force over
    the stiffness, F = 0 at the start; v = df/dt, which is the speed of the stage once it slides.
    """

    trials = {"stribeck": 1}
    reach = Parameter(
        "response",
        (1e-3, 0.5),
        "Displacement over which friction builds up.",
        scale="log",
        limit=PLAY,
        small_to="force",
    )
    stiction = Parameter(
        "1", (0, 0.5), "Excess of the break-away force over sliding friction, as a share of it.", null=0
    )
    stribeck = Parameter(
        "response/s",
        (1e-3, 100),
        "Stribeck velocity, at which stiction has fallen by a factor of e.",
        scale="log",
        end="both",
    )

    def prepare(force, reach, stiction, stribeck, dt):
        return force, reach, stiction, 1 / (stribeck * dt)

    def start(u, force, reach, stiction, fast):
        return 0.0, u

    def step(friction, before, u, force, reach, stiction, fast):
        friction = rub(friction, u - before, force, reach, stiction, fast, 1.0)
        return friction, u, u - friction


class LuGreViscous(Friction):
    """LuGre with its viscous friction: x + F + viscous dx/dt = f,  dF/dx = (g - F sgn dx/dt) / (reach g / force),
    g = force (1 + stiction exp(-(v / stribeck)^2)).

    Canudas de Wit, Olsson, Astrom & Lischinsky (1995), IEEE Trans. Autom. Control 40, 419, eq. 2 to 5, with bristles
    that bend without damping of their own. The viscous part against the stiffness is a lag, stepped exactly, of the
    force that bends the bristles.
    """

    viscous = Parameter("s", (0, 0.05), "Viscous friction over the stiffness.", null=0)
    contains = ("sensor_lag", "amplifier_lag")

    def prepare(force, reach, stiction, stribeck, viscous, dt):
        return force, reach, stiction, 1 / (stribeck * dt), *decay(viscous, dt)

    def start(u, force, reach, stiction, fast, keep, share):
        return 0.0, u, 0.0, u

    def step(friction, before, w, lagged, u, force, reach, stiction, fast, keep, share):
        w = keep * w - share * (u - before)
        friction = rub(friction, u + w - lagged, force, reach, stiction, fast, 1.0)
        return friction, u, w, u + w, u + w - friction


class Commanded(Ahead, Block):
    """Bristles that the commanded displacement f bends: x = f - F,  dF/df = (force - F sgn df/dt) / reach.

    Dahl (1976), AIAA J. 14, 1675, with f in the place of x: friction as it is taken off a commanded displacement. It
    may be so steep that x first goes the other way at a reversal. Its step is exact.
    """

    reach = replace(Friction.reach, doc="Commanded displacement over which friction builds up.")

    def prepare(force, reach):
        return force, 1 / reach

    def start(u, force, per_reach):
        return 0.0, u

    def step(friction, before, u, force, per_reach):
        friction = bend(friction, u - before, force, per_reach)
        return friction, u, u - friction


class CommandedLuGre(Commanded):
    """Commanded bristles with stiction and viscous friction: x = w - F,  viscous dw/dt + w = f,
    dF/df = (g - F sgn df/dt) / (reach g / force),  g = force (1 + stiction exp(-(v / stribeck)^2)),  v = df/dt.

    Canudas de Wit, Olsson, Astrom & Lischinsky (1995), IEEE Trans. Autom. Control 40, 419, eq. 2 to 5, with f in the
    place of x. The viscous part against the stiffness is a lag, stepped exactly.
    """

    trials = {"stribeck": 1}
    stiction, stribeck, viscous = Friction.stiction, Friction.stribeck, LuGreViscous.viscous
    contains = ("sensor_lag", "amplifier_lag")

    def prepare(force, reach, stiction, stribeck, viscous, dt):
        return force, 1 / reach, stiction, 1 / (stribeck * dt), *decay(viscous, dt)

    def start(u, force, per_reach, stiction, fast, keep, share):
        return 0.0, u, 0.0

    def step(friction, before, w, u, force, per_reach, stiction, fast, keep, share):
        pull = u - before
        w = keep * w - share * pull
        level = 1 + stiction * (1 + expm1(-pull * fast * pull * fast))
        friction = bend(friction, pull, force * level, per_reach / level)
        return friction, u, w, u + w - friction


class Coulomb(Ahead, Block):
    """Dry and viscous friction: x + viscous dx/dt = f - force tanh(v / speed).

    Coulomb's law, smoothed over `speed`: Olsson, Astrom, Canudas de Wit, Gafvert & Lischinsky (1998), Eur. J. Control
    4, 176. The viscous part against the stiffness is a lag, stepped exactly; v is the rate of the force behind it.
    """

    speed = Parameter("response/s", (1e-3, 100), "Velocity over which dry friction builds up.", scale="log")
    viscous = Parameter("s", (0, 0.05), "Viscous friction over the stiffness.", null=0)
    contains = ("sensor_lag", "amplifier_lag")

    def prepare(force, speed, viscous, dt):
        return force, 2 / (speed * dt), *decay(viscous, dt)

    def start(u, force, fast, keep, share):
        return 0.0, u, u

    def step(w, before, lagged, u, force, fast, keep, share):
        w = keep * w - share * (u - before)
        grown = expm1(max(min((u + w - lagged) * fast, 40.0), -40.0))
        return w, u, u + w, u + w - force * (grown / (grown + 2))


class CommandedCoulomb(Coulomb):
    """Dry friction of the commanded displacement f, and viscous friction: x = w - force tanh(v / speed),
    viscous dw/dt + w = f,  v = df/dt.

    Coulomb's law, smoothed over `speed`, with f in the place of x: Olsson, Astrom, Canudas de Wit, Gafvert &
    Lischinsky (1998), Eur. J. Control 4, 176. The viscous part against the stiffness is a lag, stepped exactly.
    """

    def start(u, force, fast, keep, share):
        return 0.0, u

    def step(w, before, u, force, fast, keep, share):
        pull = u - before
        w = keep * w - share * pull
        grown = expm1(max(min(pull * fast, 40.0), -40.0))
        return w, u, u + w - force * (grown / (grown + 2))


class Motion(Rubbing, Term):
    """The moving mass rubs as it is accelerated: m x'' + b x' + k (x + F) = k f, with the law of the first form in x.

    Dahl (1968), A Solid Friction Model, without stiction; Olsson, Astrom, Canudas de Wit, Gafvert & Lischinsky (1998),
    Eur. J. Control 4, 176. Ringing wears off within the reach, and v = dx/dt.
    """

    trials = {"stribeck": 1}
    solvable = False


class CoulombMotion(Rubbing, Term):
    """Dry friction of the moving mass: m x'' + b x' + k (x + friction tanh(x' / speed)) = k f; b is the viscous part.

    Coulomb's law, smoothed over `speed`: Olsson, Astrom, Canudas de Wit, Gafvert & Lischinsky (1998), Eur. J. Control
    4, 176.
    """

    solvable = False


class Slip(Rubbing, Term):
    """Elements of the guide stretch, then slip, as the mass moves: m x'' + b x' + k (x + F) = k f, F of four of them.

    Iwan (1966), J. Appl. Mech. 33, 893; Al-Bender, Lampaert & Swevers (2005), IEEE Trans. Autom. Control 50, 1883: the
    generalised Maxwell slip model, without Stribeck effect. Reversals within the reach leave closed loops.
    """

    trials = {"spacing": 2}
    solvable = False


class Elastoplastic(Rubbing, Term):
    """Bristles of the guide only bend at first, then slide, as the mass moves: m x'' + b x' + k (x + F) = k f,
    dF/dx = friction / reach while F sgn x' < elastic g, beyond it (friction / reach) (g - F sgn x') / (g - elastic g),
    g = friction (1 + stiction exp(-(x' / stribeck)^2)).

    Dupont, Hayward, Armstrong & Altpeter (2002), IEEE Trans. Autom. Control 47, 787, with a straight transition. Unlike
    LuGre's, it does not drift under a force that stays below.
    """

    trials = {"elastic": 2, "stribeck": 1}
    solvable = False


Friction.forms = {
    "lugre_viscous": LuGreViscous,
    "commanded": Commanded,
    "commanded_lugre": CommandedLuGre,
    "coulomb": Coulomb,
    "commanded_coulomb": CommandedCoulomb,
    "motion": Motion,
    "coulomb_motion": CoulombMotion,
    "slip": Slip,
    "elastoplastic": Elastoplastic,
}
