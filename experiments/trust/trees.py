"""A job as a tree, and its mutations: keys, types and values."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from typing import Any

from ruamel.yaml import YAML

from experiments.trust.mutants import READ, REFUSE, Kind, Random, kind

Tree = Any
At = tuple[str | int, ...]
STRUCTURE: Kind = {}
VALUES: Kind = {}


def read(text: str | bytes) -> Tree:
    """As another reader of YAML 1.2 does."""
    return YAML(typ="safe", pure=True).load(text)


def flow(tree: Tree) -> str:
    """A tree in YAML's flow style, which is JSON but for what is no number."""
    text = json.dumps(tree, indent=1, ensure_ascii=False)
    for word, yaml in (("NaN", ".nan"), ("-Infinity", "-.inf"), ("Infinity", ".inf")):
        text = re.sub(rf"(?<=[ \[]){word}\b", yaml, text)
    return text


def nodes(tree: Tree, at: At = ()) -> Iterator[tuple[At, Tree]]:
    yield at, tree
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield from nodes(value, (*at, key))


def get(tree: Tree, at: At) -> Tree:
    for key in at:
        tree = tree[key]
    return tree


def put(tree: Tree, at: At, value: Tree) -> Tree:
    get(tree, at[:-1])[at[-1]] = value
    return tree


def pick(tree: Tree, rng: Random, fits: Callable[[At, Tree], bool]) -> tuple[At, Tree]:
    places = [(at, value) for at, value in nodes(tree) if at and fits(at, value)]
    if not places:
        raise LookupError
    return places[rng.integers(len(places))]


def misspelt(word: str, rng: Random) -> str:
    place = int(rng.integers(1, len(word)))
    return word[:place] + "q" + word[place:]


def is_number(value: Tree) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def free_key(at: At) -> bool:
    """Axes have names of one's own."""
    return at[:-1] == ("channels", "axes")


@kind(STRUCTURE)
def key_misspelt(tree: Tree, rng: Random) -> Any:
    at, value = pick(tree, rng, lambda at, value: isinstance(at[-1], str) and not free_key(at))
    home, word = get(tree, at[:-1]), misspelt(str(at[-1]), rng)
    del home[at[-1]]
    home[word] = value
    return tree, REFUSE, word


@kind(STRUCTURE)
def key_added(tree: Tree, rng: Random) -> Any:
    _, value = pick({"": tree}, rng, lambda at, value: isinstance(value, dict) and at[1:] != ("channels", "axes"))
    value["colour"] = "blue"
    return tree, REFUSE, "colour"


@kind(STRUCTURE)
def key_missing(tree: Tree, rng: Random) -> Any:
    required = ("records", "channels", "model", "axes", "drive", "file", "bounds")
    at, _ = pick(tree, rng, lambda at, value: at[-1] in required and at[-2:-1] != ("response",) and at[0] != "limits")
    del get(tree, at[:-1])[at[-1]]
    return tree, REFUSE


@kind(STRUCTURE)
def key_optional_missing(tree: Tree, rng: Random) -> Any:
    optional = ("repeats", "seed", "stop", "limits", "effects", "polish", "shared")
    at, _ = pick(tree, rng, lambda at, value: at[0] in optional)
    del get(tree, at[:-1])[at[-1]]
    return tree, READ


@kind(STRUCTURE)
def item_missing(tree: Tree, rng: Random) -> Any:
    _, value = pick(tree, rng, lambda at, value: isinstance(value, list) and len(value) > 0)
    del value[rng.integers(len(value))]
    return tree, READ


@kind(STRUCTURE)
def emptied(tree: Tree, rng: Random) -> Any:
    at, value = pick(tree, rng, lambda at, value: at in (("records",), ("model",), ("channels",), ("channels", "axes")))
    return put(tree, at, type(value)()), REFUSE


@kind(STRUCTURE)
def branches_swapped(tree: Tree, rng: Random) -> Any:
    first, second = (pick(tree, rng, lambda at, value: isinstance(value, dict | list)) for _ in range(2))
    if first[0][: len(second[0])] == second[0] or second[0][: len(first[0])] == first[0]:
        raise LookupError
    put(tree, first[0], second[1])
    return put(tree, second[0], first[1]), READ


@kind(STRUCTURE)
def another_type(tree: Tree, rng: Random) -> Any:
    at, value = pick(tree, rng, lambda at, value: isinstance(value, dict | list) or is_number(value))
    others = ["many", None, True, [value], {"value": value}, [[]], {"a": {"b": []}}, -7]
    return put(tree, at, others[rng.integers(len(others))]), READ


@kind(STRUCTURE)
def text_of_another_type(tree: Tree, rng: Random) -> Any:
    at, _ = pick(tree, rng, lambda at, value: isinstance(value, str))
    others = [None, True, 5, -0.25, ["a", "b"], {}, ""]
    return put(tree, at, others[rng.integers(len(others))]), READ


@kind(STRUCTURE)
def key_twice(tree: Tree, rng: Random) -> Any:
    keys = [key for key in tree if key != "name"]
    key = keys[rng.integers(len(keys))]
    return flow(tree)[:-1].rstrip() + f',\n "{key}": {json.dumps(tree[key])}\n}}', REFUSE, key


@kind(VALUES)
def word_misspelt(tree: Tree, rng: Random) -> Any:
    heads = ("model", "effects", "rule_out", "shared", "optimizers", "records")
    at, word = pick(
        tree,
        rng,
        lambda at, value: (
            isinstance(value, str) and at[0] in heads and at[-1] in (["use"] if at[0] == "records" else ["name", 0, 1])
        ),
    )
    word = misspelt(word, rng)
    return put(tree, at, word), REFUSE, word


@kind(VALUES)
def number_not_finite(tree: Tree, rng: Random) -> Any:
    at, _ = pick(tree, rng, lambda at, value: is_number(value))
    value = (float("nan"), float("inf"), -float("inf"))[rng.integers(3)]
    return put(tree, at, value), REFUSE


@kind(VALUES)
def number_out_of_range(tree: Tree, rng: Random) -> Any:
    at, _ = pick(tree, rng, lambda at, value: is_number(value))
    others = (-1, 0, 1.5, -3.25, 10**30, 1e300, -1e300, 5e-324)
    return put(tree, at, others[rng.integers(len(others))]), READ


@kind(VALUES)
def number_scaled(tree: Tree, rng: Random) -> Any:
    at, number = pick(tree, rng, lambda at, value: is_number(value))
    return put(tree, at, number * float(rng.choice([0.5, 3, 1000]))), READ


@kind(VALUES)
def bounds_wrong(tree: Tree, rng: Random) -> Any:
    at, (low, high) = pick(tree, rng, lambda at, value: at[-1] == "bounds")
    wrong = ([high, low], [low, low], [low], [low, high, high + 1], [low, "high"], [], "0 to 1", {"low": low})
    return put(tree, at, wrong[rng.integers(len(wrong))]), REFUSE


@kind(VALUES)
def unit_of_another_kind(tree: Tree, rng: Random) -> Any:
    at, quantity = pick(
        tree, rng, lambda at, value: at[-1] in ("settle", "sample_rate", "target", "unit") or at[-2:-1] == ("time",)
    )
    word = "kg" if at[-1] == "unit" else f"{str(quantity).split()[0]} kg"
    return put(tree, at, word), REFUSE, "kg"


@kind(VALUES)
def file_not_there(tree: Tree, rng: Random) -> Any:
    at, _ = pick(tree, rng, lambda at, value: at[-1] == "file")
    words = (
        "nothing.csv",
        "no/where.csv",
        "../nothing.csv",
        ".",
        "a.csv/b",
        "x" * 300 + ".csv",
        "a\x00.csv",
        "~/nothing.csv",
        "",
    )
    word = words[rng.integers(len(words))]
    return put(tree, at, word), REFUSE, word[:50] if word.isprintable() else ""


@kind(VALUES)
def column_not_there(tree: Tree, rng: Random) -> Any:
    at, column = pick(
        tree, rng, lambda at, value: at[-1] in ("drive", "response", "column") or at == ("channels", "time")
    )
    if at[-1] == "column":
        value = int(rng.choice([0, -1, 99]))
        return put(tree, at, value), REFUSE, str(value)
    if at[0] == "limits" or isinstance(column, dict):
        raise LookupError
    word = str(rng.choice(["w [V]", "nothing", "u [kV/mm/s]", "U [V]x"]))
    return put(tree, at, word), REFUSE, word


@kind(VALUES)
def parameter_unknown(tree: Tree, rng: Random) -> Any:
    parameters = tree.setdefault("parameters", {})
    word = str(rng.choice(["bouc_wen.delta", "lumped", "z.bouc_wen.gain", "creep.ratio", "bouc_wen..gain", "."]))
    parameters[word] = {"value": 1}
    return tree, REFUSE, word


@kind(VALUES)
def parameter_wrong(tree: Tree, rng: Random) -> Any:
    if not tree.get("parameters"):
        raise LookupError
    at, _ = pick(tree, rng, lambda at, value: at[0] == "parameters" and len(at) == 2)
    wrong = (
        {},
        {"value": 1, "bounds": [0, 1]},
        {"value": "1 kg m"},
        {"bounds": None},
        {"value": [1]},
        5,
        {"value": True},
    )
    return put(tree, at, wrong[rng.integers(len(wrong))]), REFUSE


@kind(VALUES)
def stop_wrong(tree: Tree, rng: Random) -> Any:
    wrong = (
        {"evaluations": 0},
        {"evaluations": -5},
        {"target": "0.1 V"},
        {"target": "low"},
        {"seconds": -1},
        {"seconds": 0},
    )
    tree["stop"] = wrong[rng.integers(len(wrong))]
    return tree, REFUSE
