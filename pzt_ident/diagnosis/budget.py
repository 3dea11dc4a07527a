"""How long a diagnosis may take, and what it left out for that."""

from __future__ import annotations

from time import process_time

from pzt_ident.data.notation import listed
from pzt_ident.engine import work
from pzt_ident.engine.native import compiling_time

LEAST = 60.0  # s, of CPU
PER_SAMPLE = 1e-3  # s
BEHIND = 0.05  # of the budget: a descent that is then still behind a rival is given up
BESIDE = 0.5  # of what a path has for exploring: other effects beside one that explains most, but for a second one
EXPLORING = 0.63  # of the budget: the rest is for proving what was found
PROVING = 0.81  # of the budget: ties, intervals and what promises to explain most of what is left get no more
WHOLE = 0.9  # of the budget: the fits of a proof end there, settled or not; intervals and the next drive take the rest
PROOF = 0.05  # of the budget: what a proof may have beyond it
SLOWER = 1.25  # times a share that CPU time may take of it, where a machine is slow or a model costs more than counted
LATER = 1 / 3  # of what a share leaves of the budget: CPU time may take no more of it


class Budget:
    """Seconds of work from now on (`engine.work`), so that an answer is the same on any machine that is fast enough.
    CPU seconds of all threads, but for compiling, end it as well, its shares a little later. Infinite where None are
    given. `untried` names what they did not suffice for."""

    def __init__(self, seconds: float | None = None) -> None:
        self.seconds = float("inf") if seconds is None else seconds
        self.untried: list[str] = []
        self._first = work.done()
        self.begin_again()

    @property
    def worked(self) -> float:
        """Seconds of work since it was given."""
        return work.done() - self._first

    def part(self, share: float) -> Budget:
        """A share of the seconds, from now on; what they do not suffice for is named here."""
        part = Budget(share * self.seconds)
        part.untried = self.untried
        return part

    def begin_again(self) -> None:
        """All seconds are there, and nothing is untried."""
        self.untried.clear()
        self._begun, self._since = work.done(), computing_time()
        self.begin_path()

    def begin_path(self) -> None:
        """Other effects beside one that explains most get a part of what is left for exploring now."""
        share = self._shares()[0]
        self.beside = share + BESIDE * max(EXPLORING - share, 0.0)
        self._end = PROVING

    def begin_proof(self) -> None:
        """Fits have what was kept for them, and a little more where none of it is left."""
        self._end = WHOLE + PROOF if self.spent(WHOLE) else WHOLE

    def _shares(self) -> tuple[float, float]:
        """What is spent of the budget: by work, and by CPU time."""
        if not self.seconds:
            return WHOLE, WHOLE
        return (work.done() - self._begun) / self.seconds, (computing_time() - self._since) / self.seconds

    def allows(self, what: str, share: float = EXPLORING) -> bool:
        """Whether less than a share of the budget is spent; if not, `what` is untried."""
        enough = not self.spent(share)
        if not enough and what not in self.untried:
            self.untried.append(what)
        return enough

    def spent(self, share: float) -> bool:
        """Whether a share of the budget is spent."""
        worked, taken = self._shares()
        return worked >= share or taken >= min(SLOWER * share, share + LATER * max(WHOLE - share, 0.0))

    def lasts(self) -> bool:
        """Whether a fit may go on."""
        return self.allows("settled fits", self._end)

    @property
    def sentence(self) -> str:
        """What was not tried; empty where all was."""
        if not self.untried:
            return ""
        return f" The budget of {self.seconds:g} s did not suffice for {listed(self.untried)}: give more with --budget."


def computing_time() -> float:
    """CPU seconds of this process; kernels that a first use compiles leave it no less for its verdict."""
    return process_time() - compiling_time()


def sensible(samples: int) -> float:
    """The seconds that a job of so many samples is given."""
    return max(LEAST, PER_SAMPLE * samples)
