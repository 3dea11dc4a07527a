"""Exact steps of linear elements whose input is linear between its samples (first-order hold)."""

from math import cos, exp, expm1, sin, sqrt


def decay(tau, dt):
    """Of a lag with time constant `tau`: the factor on its deviation over a sample of dt, and on the input's change."""
    if tau == 0:
        return 0.0, 0.0
    lost = -expm1(-dt / tau)
    return 1 - lost, lost * tau / dt


def oscillator(omega, zeta, dt):
    """x'' / omega^2 + 2 zeta x' / omega + x = f: coefficients for `oscillate`.

    With w = x - f and v = x' / omega, a step is (w, v) <- exp(A T) (w, v) + b (f1 - f0). Valid without damping, under-,
    over- and critically damped, and above the Nyquist frequency.
    """
    angle = omega * dt
    cosine, sine = rotation(zeta, angle)
    r11, r12 = cosine + zeta * sine, sine
    r21, r22 = -sine, cosine - zeta * sine
    lag, speed = 2 * zeta / angle, 1 / angle
    return r11, r12, r21, r22, r11 * lag - r12 * speed - lag, r21 * lag - r22 * speed + speed


def mode(mass, damping, stiffness, dt):
    """Coefficients of a mass on a spring and damper for `oscillate`."""
    return oscillator(sqrt(stiffness / mass), damping / (2 * sqrt(stiffness * mass)), dt)


def trapezoid(omega, zeta, dt):
    """Coefficients by the modified trapezoid rule: Smith et al., Model Development for AFM Stage Mechanisms, eq. 42.

    (I - A T / 2) z1 = (I + A T / 2) z0 + T B (f0 + f1) / 2, written for the deviation from rest.
    """
    half = omega * dt / 2
    lag = 2 * zeta * half
    divisor = 1 + lag + half * half
    r11, r12 = (1 + lag - half * half) / divisor, 2 * half / divisor
    r21, r22 = -r12, (1 - lag - half * half) / divisor
    return r11, r12, r21, r22, -(1 + lag) / divisor, half / divisor


def oscillate(w, v, push, r11, r12, r21, r22, b1, b2):
    """(w, v) after a sample over which f changes by `push`; x = f + w."""
    return r11 * w + r12 * v + b1 * push, r21 * w + r22 * v + b2 * push


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
