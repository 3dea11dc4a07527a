"""The root of an increasing function, one evaluation a call: Chandrupatla (1997), Adv. Eng. Softw. 28, 145.

The caller evaluates; so one text serves a function in Python, in compiled code and in exported C. `search` is an
array of SIZE numbers: the trial X, what is known while a bracket is sought (STEP, LOW, HIGH, BEST, LEAST), and the
bracket.
"""

from numba import njit

SIZE = 15
X, STEP, LOW, HIGH, RATE, BEST, LEAST, WRONG, PHASE, A, FA, B, FB, C, FC = range(SIZE)
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
    """Take f at the trial X and set the next trial. False once X is the root, or where there is none between the
    limits, the trial nearest to one.

    WRONG is 1 where the function first moved away from its root: there it does not increase.
    """
    if f == 0.0:
        return False
    if search[PHASE] == CLOSING:
        return close(search, f)
    if search[PHASE] == WIDENING and (f > 0.0) != (search[FA] > 0.0):
        search[PHASE] = CLOSING
        search[B], search[FB], search[A], search[FA] = search[A], search[FA], search[X], f
        search[X] = search[A] + search[FA] / (search[FA] - search[FB]) * (search[B] - search[A])
        return True
    return widen(search, f)


@njit(cache=True)
def widen(search, f):
    """A step further, three times as long as the last one."""
    if search[PHASE] == FIRST:
        search[STEP] = max(search[STEP], 1.2 * abs(f / search[RATE]))
    else:
        search[STEP] = 3.0 * search[STEP]
        search[WRONG] = 1.0 if abs(f) > abs(search[FA]) else search[WRONG]
    if search[PHASE] == FIRST or abs(f) < search[LEAST]:
        search[BEST], search[LEAST] = search[X], abs(f)
    search[PHASE], search[A], search[FA] = WIDENING, search[X], f
    down = (f > 0.0) == (search[RATE] > 0.0)
    search[X] = max(search[X] - search[STEP], search[LOW]) if down else min(search[X] + search[STEP], search[HIGH])
    if search[X] == search[A]:
        search[X] = search[BEST]
        return False
    return True


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
