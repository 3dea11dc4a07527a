"""How long a diagnosis may take, and what it left out for that."""

from __future__ import annotations

from time import process_time

from pzt_ident.data.notation import listed

LEAST = 60.0  # s, of CPU
PER_SAMPLE = 1e-3  # s
EXPLORING = 0.7  # of the budget: the rest is for proving what was found
LAST = 2.0  # of the budget: fits end there, settled or not


class Budget:
    """CPU seconds from now on, of all threads; infinite where None are given. `untried` names what they did not
    suffice for."""

    def __init__(self, seconds: float | None = None) -> None:
        self.seconds = float("inf") if seconds is None else seconds
        self.untried: list[str] = []
        self._begun = process_time()

    def allows(self, what: str, share: float = EXPLORING) -> bool:
        """Whether less than a share of the budget is spent; if not, `what` is untried."""
        enough = not self.spent(share)
        if not enough and what not in self.untried:
            self.untried.append(what)
        return enough

    def spent(self, share: float) -> bool:
        """Whether a share of the budget is spent."""
        return process_time() - self._begun >= share * self.seconds

    def lasts(self) -> bool:
        """Whether a fit may go on."""
        return self.allows("settled fits", LAST)

    @property
    def sentence(self) -> str:
        """What was not tried; empty where all was."""
        if not self.untried:
            return ""
        return f" The budget of {self.seconds:g} s did not suffice for {listed(self.untried)}: give more with --budget."


def sensible(samples: int) -> float:
    """The seconds that a job of so many samples is given."""
    return max(LEAST, PER_SAMPLE * samples)
