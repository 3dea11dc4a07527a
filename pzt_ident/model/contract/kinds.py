"""The functions of each kind of block: what they are given and what they give."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

from pzt_ident.model.contract.declared import parameters

PREPARED = {"prepare": "given -> *coefficients"}
STEPPED = PREPARED | {"start": "u, *coefficients -> *states", "step": "*states, u, *coefficients -> *states, y"}
KINDS = {
    "block": STEPPED,
    "operator": {
        "prepare": "given -> (shared), (along), (against)",
        "start": "u -> states,",
        "travel": "distance, *along -> keep, add",
        "near": "further, keep, add, *along -> keep, add",
        "exact": "q, distance, (along), (against) -> q",
        "output": "h, u, *shared -> y",
        "terms?": "given -> *terms",
        "lift?": "distance, u, sign, *terms -> factor",
        "fade?": "*terms -> share",
    },
    "bank": STEPPED
    | {
        "output": "u, total, *coefficients -> y",
        "rests?": "*states, low, high, *coefficients -> still",
        "stands?": "branches -> drive",
        "count?": "settings -> branches",
        "solve?": "own",
    },
    "relays": {
        "prepare": "given -> (shape), (energy), (shared)",
        "field": "u, *shape -> field",
        "coercive_field": "i, *shape -> coercive",
        "mass": "low, high, *shape -> weight",
        "start": "field, coercive, low, high, *shape -> share",
        "leave": "further, *energy -> rate, keep, response",
        "output": "u, total, *shared -> y",
    },
    "term": {},
    "shift": {"prepare": "given -> coefficients,"},
    "beside": STEPPED | {"start": "f, *coefficients -> *states", "step": "*states, x, f, *coefficients -> *states, y"},
    "addition": {"basis": "t, own parameters -> *amounts", "guess?": "times, drives, residuals, low, high"},
    "modes": PREPARED | {"start": "p, *coefficients -> +states", "step": "*states, p, *coefficients -> *states, q"},
    "coupling": PREPARED | {"step": "y, other, *coefficients -> y"},
}
"""By kind: function -> what it is given -> what it gives. `?`: may be left out. `*` stands for all of a group, which is
as many as the function that gives it gives; `+` for one or more; `(...)` for a tuple of one or more; a comma at the end
for a tuple of one; a name in WORDED for what a function asks for by name. What gives nothing here is not tried."""

ANY = {"refuse?": "least, most"}
WORDED = ("given", "own parameters", "branches", "settings")
BRANCHED = ("bank", "modes")


class Owed(NamedTuple):
    arguments: tuple[str, ...]
    results: tuple[str, ...]
    packed: bool

    @property
    def worded(self) -> str:
        return next((token for token in self.arguments if token in WORDED), "")


def kinds(block: Any) -> tuple[type, ...]:
    """The classes that a block's author derives it from."""
    return tuple(base for base in block.__mro__ if KINDS.get(str(vars(base).get("kind"))) is not None)


def kind_of(block: Any) -> str:
    """The kind of a block; empty for what is none."""
    return next((vars(base)["kind"] for base in kinds(block)), "")


def owed(block: Any) -> dict[str, Owed]:
    """The functions that a block must have, or has."""
    found = {}
    for name, text in (KINDS[kind_of(block)] | ANY).items():
        word = name.removesuffix("?")
        if word == name or getattr(block, word, None) is not None or _asked_for(block, word):
            found[word] = _parsed(text)
    return found


def _asked_for(block: Any, word: str) -> bool:
    """Whether what else a block declares makes a function of it necessary that others do without."""
    if word == "solve":
        return bool(block.solved)
    inside = [item.effect for item in parameters(block).values() if item.effect and item.effect not in block.forms]
    terms = ("terms", "lift", "fade")
    return word in terms and (bool(inside) or any(getattr(block, each, None) is not None for each in terms))


@cache
def _parsed(text: str) -> Owed:
    given, _, gives = text.partition(" -> ")
    results = tuple(token.strip() for token in gives.rstrip(",").split(",") if token.strip())
    return Owed(tuple(given.split(", ")), results, gives.endswith(",") or len(results) > 1 or gives[:1] in ("*", "+"))
