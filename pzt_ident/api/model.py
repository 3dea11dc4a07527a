"""The blocks of a model, by their words."""

from __future__ import annotations

from collections.abc import Collection, Sequence
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
        if not words:
            raise InputError("no block", where="model", remedy="give words, as in Model('bouc_wen', 'lumped')")
        self.blocks = tuple(map(_choice, words))
        self.effects, self.shared = _words(effects, "effects"), _words(shared, "shared")
        for item in self.blocks:
            _known(word_of(item), blocks.words(), "model", "block")
        chosen = list(map(word_of, self.effects))
        for effect in chosen:
            _known(effect, blocks.effects(), "effects", "effect")
            if chosen.count(effect) > 1:
                raise InputError(f"{effect!r} occurs twice", where="effects", remedy="give each effect once")
        blocks.chain((*self.blocks, *self.effects))

    @classmethod
    def of(cls, job: Job) -> Model:
        """That of a job."""
        return cls(*map(_settings, job.model), effects=job.effects, shared=job.shared)

    def with_effects(self, effects: Sequence[str]) -> Model:
        """The same chain with these effects in the place of its own."""
        return Model(*map(_settings, self.blocks), effects=effects, shared=self.shared)

    def with_blocks(self, words: Collection[str]) -> Model:
        """The same model with only those of its blocks that have these words."""
        kept = (item for item in self.blocks if word_of(item) in words)
        return Model(*map(_settings, kept), effects=self.effects, shared=self.shared)

    def __repr__(self) -> str:
        return " + ".join([" -> ".join(map(word_of, self.blocks)), *self.effects])


def _choice(word: Word) -> str | Choice:
    if isinstance(word, str):
        return word
    if not isinstance(word, dict) or "name" not in word:
        remedy = "give a word, or {'name': 'rod', 'elements': 12}"
        raise InputError(f"{word!r} is no block", where="model", remedy=remedy)
    return Choice(word["name"], {key: value for key, value in word.items() if key != "name"})


def _settings(item: str | Choice) -> Word:
    return item if isinstance(item, str) else {"name": item.name, **item.settings}


def _words(words: str | Sequence[str], where: str) -> tuple[str, ...]:
    """One word, or several."""
    listed = (words,) if isinstance(words, str) else words
    if not isinstance(listed, list | tuple) or not all(isinstance(word, str) for word in listed):
        raise InputError(f"{words!r} is no list of words", where=where, remedy="give words, as in ['creep']")
    return tuple(listed)


def _known(word: Any, words: Sequence[str], where: str, kind: str) -> None:
    if word not in words:
        raise InputError(f"unknown {kind} {word!r}", where=where, remedy=nearest(str(word), words))
