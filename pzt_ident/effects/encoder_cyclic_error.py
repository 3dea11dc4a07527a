"""Error of an encoder with the period of its grating."""

from math import pi, sqrt

from pzt_ident.model.block import Block, Place, cos, sin
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class EncoderCyclicError(Block):
    """Imperfect encoder signals between lines of the grating: y = x + a sin(2 pi x / p) + b (cos(2 pi x / p) - 1).

    Fleming (2013), Sensors and Actuators A 190, 106 (sub-divisional error). Zero at x = 0; valid for |x| < 1000 p.
    """

    place = Place.SENSOR
    form = Form(
        "first",
        ("first", "second", "elliptic", "rezeroed"),
        "Up to which harmonic of the grating, and from which zero.",
    )
    trials = {"pitch": 120}
    line = "pitch"
    sine = Parameter("response", (-0.05, 0.05), "Error of the first harmonic, odd about x = 0, a.", null=0)
    cosine = Parameter("response", (-0.05, 0.05), "Error of the first harmonic, even about x = 0, b.", null=0)
    pitch = Parameter(
        "response",
        (0.01, 0.8),
        "Period of the grating's signal: the stroke is at least one and a quarter of it, p.",
        scale="log",
    )
    look_alikes = ("quadratic_gain", "cubic_stiffness", "saturation")
    separate_by = "Shift the encoder head by half a pitch and repeat: this error changes its sign, all others stay."
    remedy = "Correct offset, gain and phase of the encoder's signals, or subtract the error tabulated over a pitch."

    def prepare(sine, cosine, pitch):
        return sine, cosine, 2 * pi / pitch

    def start(u, sine, cosine, wave):
        return ()

    def step(u, sine, cosine, wave):
        return u + sine * sin(wave * u) + cosine * (cos(wave * u) - 1)


class SecondHarmonic(EncoderCyclicError):
    """Unequal gains of the two signals: y = x + ... + c sin(4 pi x / p) + d (cos(4 pi x / p) - 1).

    Heydemann (1981), Applied Optics 20, 3382.
    """

    second_sine = Parameter("response", (-0.05, 0.05), "Error of the second harmonic, odd about x = 0, c.", null=0)
    second_cosine = Parameter("response", (-0.05, 0.05), "Error of the second harmonic, even about x = 0, d.", null=0)

    def prepare(sine, cosine, second_sine, second_cosine, pitch):
        return sine, cosine, second_sine, second_cosine, 2 * pi / pitch

    def start(u, sine, cosine, second_sine, second_cosine, wave):
        return ()

    def step(u, sine, cosine, second_sine, second_cosine, wave):
        a, b = sin(wave * u), cos(wave * u)
        return u + sine * a + cosine * (b - 1) + 2 * second_sine * a * b - 2 * second_cosine * a * a


class Elliptic(SecondHarmonic):
    """Two signals that are an ellipse beside the origin, read by the angle: y = x + (arg w(x) - arg w(0)) p / 2 pi,
    w = 1 + o exp(-i theta) + k exp(-2 i theta), theta = 2 pi x / p; o are their offsets, k is from unequal gains and a
    phase that is no quarter of a period. To first order the error is that with two harmonics.

    Heydemann (1981), Applied Optics 20, 3382.
    """

    def prepare(sine, cosine, second_sine, second_cosine, pitch):
        wave = 2 * pi / pitch
        beside, oval = (-wave * sine, wave * cosine), (-wave * second_sine, wave * second_cosine)
        return *beside, *oval, angle_of(1 + beside[0] + oval[0], beside[1] + oval[1]), wave

    def start(u, along, across, oval, skew, begun, wave):
        return ()

    def step(u, along, across, oval, skew, begun, wave):
        a, b = sin(wave * u), cos(wave * u)
        c, d = 2 * a * b, b * b - a * a
        real = 1 + along * b + across * a + oval * d + skew * c
        return u + (angle_of(real, across * b - along * a + skew * d - oval * c) - begun) / wave


def angle_of(x, y):
    """arg(x + i y): of an eighth of it by the series of the arc tangent, to 1e-11 up to a right angle."""
    half = y / (x + sqrt(x * x + y * y))
    quarter = half / (1 + sqrt(1 + half * half))
    t = quarter / (1 + sqrt(1 + quarter * quarter))
    s = t * t
    return 8 * t * (1 - s * (1 / 3 - s * (1 / 5 - s * (1 / 7 - s * (1 / 9 - s * (1 / 11 - s / 13))))))


class Rezeroed(EncoderCyclicError):
    """The encoder is set to zero, or the stage clamped anew, before each record r, which begins at another place on the
    grating: y = x + a_r sin(2 pi x / p) + b_r (cos(2 pi x / p) - 1).

    Fleming (2013), Sensors and Actuators A 190, 106. A stroke has four lines of the grating or more: with fewer the
    amounts of a record would bend its reading like any curve.
    """

    alike = ("sine", "cosine")
    sine = Parameter("response", (-0.05, 0.05), "Error of a record, odd about x = 0, a.", null=0, per_record=True)
    cosine = Parameter("response", (-0.05, 0.05), "Error of a record, even about x = 0, b.", null=0, per_record=True)
    pitch = Parameter("response", (0.01, 0.25), "Period of the grating's signal, p.", scale="log")


EncoderCyclicError.forms = {"second": SecondHarmonic, "elliptic": Elliptic, "rezeroed": Rezeroed}
