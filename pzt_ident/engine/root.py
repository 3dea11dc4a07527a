"""The root of an increasing function, one evaluation a call: Chandrupatla (1997), Adv. Eng. Softw. 28, 145.

The caller evaluates; so one text serves a function in Python, in compiled code and in exported C. `search` is an
array of SIZE numbers: the trial X, its STEP and the LIMITS while a bracket is sought, and the bracket.
"""

from numba import njit

SIZE = 14
X, STEP, LOW, HIGH, PHASE, A, FA, B, FB, C, FC, T, WRONG, RATE = range(SIZE)
FIRST, WIDENING, CLOSING = 0.0, 1.0, 2.0
EPSILON = 4.5e-16


@njit(cache=True)
def begin(search, x, step, low, high, rate):
    """Start at x, with steps of at least `step`; rate: an estimate of the slope, whose sign is that of the slope."""
    search[X] = min(max(x, low), high)
    search[STEP], search[LOW], search[HIGH], search[RATE] = step, low, high, rate
    search[PHASE], search[WRONG] = FIRST, 0.0


@njit(cache=True)
def propose(search, f):
    """Take f at the trial X and set the next trial. False once X is the root, or the limit where there is none.

    WRONG is 1 where the function first moved away from its root: there it does not increase.
    """
    if f == 0.0:
        return False
    if search[PHASE] == CLOSING:
        return close(search, f)
    if search[PHASE] == WIDENING and (f > 0.0) != (search[FA] > 0.0):
        search[PHASE] = CLOSING
        search[B], search[FB], search[A], search[FA] = search[A], search[FA], search[X], f
        search[T] = search[FA] / (search[FA] - search[FB])
        search[X] = search[A] + search[T] * (search[B] - search[A])
        return True
    if search[PHASE] == WIDENING and abs(f) > abs(search[FA]):
        search[WRONG] = 1.0
    search[STEP] = 3.0 * search[STEP] if search[PHASE] == WIDENING else max(search[STEP], 1.2 * abs(f / search[RATE]))
    search[PHASE], search[A], search[FA] = WIDENING, search[X], f
    down = (f > 0.0) == (search[RATE] > 0.0)
    search[X] = max(search[X] - search[STEP], search[LOW]) if down else min(search[X] + search[STEP], search[HIGH])
    return search[X] != search[A]


@njit(cache=True)
def close(search, f):
    """One step of Chandrupatla's method: inverse quadratic interpolation where that is safe, else bisection."""
    if (f > 0.0) == (search[FA] > 0.0):
        search[C], search[FC] = search[A], search[FA]
    else:
        search[C], search[FC], search[B], search[FB] = search[B], search[FB], search[A], search[FA]
    search[A], search[FA] = search[X], f
    a, b, c, fa, fb, fc = search[A], search[B], search[C], search[FA], search[FB], search[FC]
    search[X] = a if abs(fa) < abs(fb) else b
    nearest = EPSILON * abs(search[X]) / abs(b - a)
    if nearest > 0.5:
        return False
    xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
    t = 0.5
    if phi * phi < xi and (1 - phi) * (1 - phi) < 1 - xi:
        t = fa / (fb - fa) * (fc / (fb - fc)) + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
    t = min(max(t, nearest), 1 - nearest)
    search[X] = a + t * (b - a)
    return True
