"""The functions of each kind of block: their arguments and results."""

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
        "reach": "q, *against -> distance",
        "output": "h, u, *shared -> y",
        "quadrant?": "way, rate, distance, u, sign, *shared -> *along",
        "terms?": "given -> *terms",
        "lift?": "distance, u, sign, *terms -> factor",
        "fade?": "h, *terms -> share",
    },
    "bank": STEPPED
    | {
        "output": "u, total, *coefficients -> y",
        "rests?": "*states, low, high, *coefficients -> still",
        "rides?": "state, first, last, back, *coefficients -> along",
        "limits?": "state, low, high, *coefficients -> least, most",
        "read?": "state, *coefficients -> y",
        "bend?": "*coefficients -> width",
        "threshold?": "branches -> drive",
        "count?": "settings -> branches",
        "solve?": "values",
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
    "coupling": PREPARED
    | {"start": "y, other, *coefficients -> *states", "step": "*states, y, other, *coefficients -> *states, y"},
}
"""By kind of block: function name -> "arguments -> results". `?`: the function is optional. `*`: all values of a group,
as many as the function that returns it returns; `+`: one or more; `(...)`: a tuple of one or more; a comma at the end:
a tuple of one; a name in ASKED_BY_NAME: arguments that the function asks for by name. A function without results is not
called by the check."""

ANY = {"refuse?": "least, most"}
ASKED_BY_NAME = ("given", "own parameters", "branches", "settings")
BRANCHED = ("bank", "modes")
SMOOTH = ("rests", "rides", "limits", "read", "bend")  # a bank with `read` has all of them


class Signature(NamedTuple):
    """Arguments and results of one function; packed: it returns a tuple."""

    arguments: tuple[str, ...]
    results: tuple[str, ...]
    packed: bool

    @property
    def asked_by_name(self) -> str:
        return next((token for token in self.arguments if token in ASKED_BY_NAME), "")


def kinds(block: Any) -> tuple[type, ...]:
    """The base classes of a block that an author derives from."""
    return tuple(base for base in block.__mro__ if KINDS.get(str(vars(base).get("kind"))) is not None)


def kind_of(block: Any) -> str:
    """The kind of a block; empty for a class that is no block."""
    return next((vars(base)["kind"] for base in kinds(block)), "")


def signatures(block: Any) -> dict[str, Signature]:
    """The signatures of the functions that a block must define or does define, by name."""
    signatures_by_name = {}
    for name, text in (KINDS[kind_of(block)] | ANY).items():
        word = name.removesuffix("?")
        if word == name or getattr(block, word, None) is not None or _required(block, word):
            signatures_by_name[word] = _parsed(text)
    return signatures_by_name


def _required(block: Any, word: str) -> bool:
    """Whether another declaration of the block makes an optional function necessary."""
    if word == "solve":
        return bool(block.solved)
    if word in SMOOTH:
        return getattr(block, "read", None) is not None
    effects = {effect for item in parameters(block).values() for effect in item.effects} - block.forms.keys()
    terms = ("terms", "lift", "fade")
    return word in terms and (bool(effects) or any(getattr(block, term, None) is not None for term in terms))


@cache
def _parsed(text: str) -> Signature:
    arguments, _, returned = text.partition(" -> ")
    results = tuple(token.strip() for token in returned.rstrip(",").split(",") if token.strip())
    is_tuple = returned.endswith(",") or len(results) > 1 or returned[:1] in ("*", "+")
    return Signature(tuple(arguments.split(", ")), results, is_tuple)
