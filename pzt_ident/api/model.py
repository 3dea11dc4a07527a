"""The blocks of a model, by their words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.job.schema import Job
from pzt_ident.job.sections import Choice
from pzt_ident.model.registry import blocks, word_of

Word = str | dict[str, Any]


class Model:
    """A chain of blocks: `Model("bouc_wen", "lumped")`, with settings `Model("bouc_wen", {"name": "rod", "elements":
    12})`, with effects `Model("bouc_wen", effects=["creep"])`. shared: parameters that are one for all axes.

    Raises InputError for an unknown word or setting, with the nearest known ones.
    """

    def __init__(self, *words: Word, effects: Sequence[str] = (), shared: Sequence[str] = ()) -> None:
        self.blocks = tuple(map(_choice, words))
        self.effects, self.shared = tuple(effects), tuple(shared)
        for item in self.blocks:
            _known(word_of(item))
        for effect in self.effects:
            _known(effect)
        blocks.chain((*self.blocks, *self.effects))

    @classmethod
    def of(cls, job: Job) -> Model:
        """That of a job."""
        made = cls(effects=job.effects, shared=job.shared)
        made.blocks = job.model
        return made

    def with_effects(self, effects: Sequence[str]) -> Model:
        """The same chain with these effects in the place of its own."""
        changed = Model(effects=effects, shared=self.shared)
        changed.blocks = self.blocks
        return changed

    def __repr__(self) -> str:
        return " -> ".join([*map(word_of, self.blocks), *(f"+ {effect}" for effect in self.effects)])


def _choice(word: Word) -> str | Choice:
    if isinstance(word, str):
        return word
    if not isinstance(word, dict) or "name" not in word:
        remedy = "give a word, or {'name': 'rod', 'elements': 12}"
        raise InputError(f"{word!r} is no block", where="model", remedy=remedy)
    return Choice(word["name"], {key: value for key, value in word.items() if key != "name"})


def _known(word: str) -> None:
    if word not in blocks:
        raise InputError(f"unknown block or effect {word!r}", where="model", remedy=nearest(word, blocks.words()))
