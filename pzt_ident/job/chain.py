"""The chain of blocks of a job, built once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pzt_ident.model.registry import blocks

if TYPE_CHECKING:
    from pzt_ident.data.record import Axis
    from pzt_ident.job.sections import Choice
    from pzt_ident.model.chain import Chain


@dataclass(frozen=True)
class ChainParts:
    """All that the model of a job depends on. `given`: names of the parameters that the job sets."""

    items: tuple[str | Choice, ...]
    axes: tuple[str, ...]
    measured: tuple[int, ...]
    shared: tuple[str, ...]
    given: frozenset[str]

    @classmethod
    def of(cls, items: Iterable[str | Choice], axes: Mapping[str, Axis], shared: Any, given: Any) -> ChainParts:
        measured = tuple(i for i, axis in enumerate(axes.values()) if axis.response is not None)
        return cls(tuple(items), tuple(axes), measured, tuple(shared), frozenset(given))

    def chain(self) -> Chain:
        """The chain of the known words; unknown words are left out."""
        from pzt_ident.model.chain import Chain

        chosen = list(dict.fromkeys(blocks.chain(self.items)))
        return Chain(chosen, self.axes, self.measured, self.shared, self.given)


class CachedChain:
    """The chain of a job, built once, and again only for other parts.

    It is not part of what the job says: all compare equal, and a copy in another process is empty.
    """

    def __init__(self) -> None:
        self._parts: ChainParts | None = None
        self._chain: Chain | None = None

    def of(self, parts: ChainParts) -> Chain:
        if self._chain is None or self._parts != parts:
            self._parts, self._chain = parts, parts.chain()
        return self._chain

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CachedChain)

    def __reduce__(self) -> tuple[type[CachedChain], tuple[()]]:
        return CachedChain, ()
