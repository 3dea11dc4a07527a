"""What is diagnosed: a job's model, its records, and the effects that may be added to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import error_scales, noise_floor, pooled_floor
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.budget import BEHIND, Budget
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.engine import work
from pzt_ident.model.block import Coupling
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import Choice, blocks, word_of
from pzt_ident.search.cube import FixedValue, ParameterSpec
from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]
Listener = Callable[[dict[str, Any]], None]


class Case:
    """A model, its records and its parameter specifications; effects that are not ruled out can be added to it.

    `on_event` is called, from any thread, with every fitted start, scored effect and refitted model; errors are in
    units of the loss. `base_problem` is the problem of the model without further effects, if it exists already.
    `budget` has no end unless it is set. `caveat`: a sentence on the records that stands beside every verdict.
    """

    def __init__(
        self,
        words: Sequence[str | Choice],
        effects: Sequence[str],
        records: Sequence[Record],
        specs: Any,
        ruled_out: Sequence[str] = (),
        shared: Sequence[str] = (),
        on_event: Listener = lambda event: None,
        base_problem: Problem | None = None,
    ) -> None:
        self.on_event, self._base_problem, self.budget = on_event, base_problem, Budget()
        self.words, self.effects = tuple(words), tuple(effects)
        self.ruled_out, self.shared = tuple(ruled_out), tuple(shared)
        self.caveat = ""
        self._resampled: dict[tuple[int, int], Record] = {}
        self.refits: dict[Any, Fit] = {}  # by effects, steps and start
        self.wider: dict[Any, tuple[Case, Fit]] = {}  # fits gone on with beyond bounds, by slip, effects and point
        self.unlike: dict[Any, tuple[Case, Fit] | None] = {}  # with axes of their own mechanics, by effects and point
        self.faults: dict[str, Fit] = {}  # fits of the model as given with a fault of the set-up, by its word
        self.shares: dict[str, float] = {}  # of the misfit as given that each effect alone explains, by its word
        self.scorers: list[Any] = []  # of the fits that were diagnosed last
        self.reshaped: Case | None = (
            None  # with drives that go otherwise between their samples, once that was asked for
        )
        self.records, self.specs, self.error_scales = tuple(records), specs, error_scales(list(records))

    def with_specs(self, specs: Mapping[str, ParameterSpec]) -> Case:
        """The same case with other specifications of some parameters, by their names in the job."""
        return self._altered(self.words, {**self.specs, **specs})

    def with_words(self, words: Sequence[str | Choice]) -> Case:
        """The same case with other blocks."""
        return self._altered(words, self.specs)

    def with_records(self, records: Sequence[Record]) -> Case:
        """The same case, of which other records judge."""
        return self._altered(self.words, self.specs, records)

    def on_axis(self, axis: int | None) -> Case:
        """The same case with the noise floor of one measured axis alone, of which no shares are known; the case itself
        for None."""
        if axis is None:
            return self
        other = copy(self)
        other.floor, other.shares = float(self.floors[axis]), {}
        return other

    def _altered(self, words: Sequence[str | Choice], specs: Any, records: Sequence[Record] | None = None) -> Case:
        other = Case(words, self.effects, records or self.records, specs, self.ruled_out, self.shared, self.on_event)
        if records is None:
            other._resampled = self._resampled
        other.budget, other.caveat, other.shares = self.budget, self.caveat, self.shares
        other.error_scales, other.floor = self.error_scales, self.floor
        return other

    def problem(self, effects: Sequence[str], steps: Sequence[int] = (), measured_only: bool = False) -> Problem:
        """steps: simulation steps per sample of each record, by default those of the job; `measured_only` as in
        `Fit`."""
        if self._base_problem and (tuple(effects), tuple(steps), measured_only) == (self.effects, (), False):
            return self._base_problem
        first = self.records[0]
        chain = blocks.chain((*self.words, *effects))
        nulls = self.unmeasured_nulls(effects) if measured_only else {}
        specs = {name: FixedValue(null) for name, null in nulls.items()} | self.specs
        model = Chain(chain, first.axes, first.measured, self.shared, specs)
        counts = steps or [record.steps for record in self.records]
        records = [self.record_with_steps(number, count) for number, count in enumerate(counts)]
        return Problem(model, records, specs, self.error_scales)

    def unmeasured_nulls(self, effects: Sequence[str]) -> dict[str, float]:
        """Parameters, by name, that switch the added effects off on axes without a response: their nulls there, in the
        user's units. Empty where no coupling lets a response depend on such an axis."""
        first, chain = self.records[0], blocks.chain((*self.words, *effects))
        if not any(issubclass(block, Coupling) for block in chain):
            return {}
        unmeasured = [axis for number, axis in enumerate(first.axes) if number not in first.measured]
        added = {word_of(item) for item in effects if item not in self.effects}
        return {
            f"{axis}.{block.name}.{word}": parameter.null
            for axis, block in product(unmeasured, chain)
            for word, parameter in block.parameters().items()
            if {block.name, parameter.effect_word} & added
            and parameter.null is not None
            and Chain.allowed_without_response(block, parameter)
            if f"{block.name}.{word}" not in (*self.shared, *self.specs)
        }

    def words_of(self, fit: Fit) -> tuple[str | Choice, ...]:
        """The blocks of this case that are in the model of a fit, which may do without some, and what that follows of
        the time before the records."""
        model, own = fit.problem.model.blocks, [*map(word_of, self.words)]
        names = {block.name for block in model}
        before = [block for block in model if block.lead and block.name not in own]
        items = [item for block in before for item in blocks.forms(block.name) if blocks[item] is block]
        return (*items, *(item for item in self.words if word_of(item) in names))

    def record_with_steps(self, number: int, steps: int) -> Record:
        """A record simulated in so many steps per sample; always the same object, so that its signals are prepared
        once."""
        return self._resampled.setdefault((number, steps), replace(self.records[number], steps=steps))

    def descend(self, problem: Problem, point: Array, rival: float = np.inf, rough: bool = False) -> Array:
        """The point that few steps reach while the budget lasts, of which a descent behind a rival gets no more than a
        part, see `search.descent`."""
        end = work.done() + BEHIND * self.budget.seconds
        return descend(
            problem, point, going=self.budget.lasts, rival=rival, patient=lambda: work.done() < end, rough=rough
        )

    @cached_property
    def floor(self) -> float:
        """Noise floor of all measured axes together, in units of the loss."""
        return pooled_floor(list(self.records))

    @cached_property
    def floors(self) -> Array:
        """Noise floor of each measured axis, in units of the loss: (measured axes,)."""
        records = list(self.records)
        floors = [noise_floor(records, axis).value for axis in records[0].measured]
        return np.asarray(floors / error_scales(records))
