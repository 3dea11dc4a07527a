"""Malformed jobs: mutations of good ones in structure, values, text and bytes, and what must come of each."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from experiments.trust import mutants
from experiments.trust.good import JOBS
from experiments.trust.mutants import BYTES, READ, REFUSE, SAME, Kind, Mutant, Random, kind
from experiments.trust.trees import STRUCTURE, VALUES, Tree, flow, read

TEXT: Kind = {}


def mutant(base: str, rng: Random) -> Mutant:
    """A mutation of a good job by chance."""
    text = JOBS[base]
    kinds = (
        (STRUCTURE, 0.35, lambda: read(text), flow),
        (VALUES, 0.35, lambda: read(text), flow),
        (TEXT, 0.15, lambda: text, str),
        (BYTES, 0.15, text.encode, str),
    )
    return mutants.mutant(kinds, rng)


@kind(TEXT)
def commented(text: str, rng: Random) -> Any:
    return "# a comment: {\n\n" + "\n".join(f"{line}  # [{i}" for i, line in enumerate(text.splitlines())) + "\n", SAME


kind(TEXT)(mutants.carriage_returns)
kind(TEXT)(mutants.byte_order_mark)


@kind(TEXT)
def flow_style(text: str, rng: Random) -> Any:
    return flow(read(text)), SAME


@kind(TEXT)
def keys_in_another_order(text: str, rng: Random) -> Any:
    tree = read(text)
    return flow({key: tree[key] for key in rng.permutation(list(tree)).tolist()}), SAME


kind(TEXT)(mutants.without_last_newline)


@kind(TEXT)
def tabs(text: str, rng: Random) -> Any:
    return text.replace("\n  ", "\n\t"), REFUSE


@kind(TEXT)
def indented_wrongly(text: str, rng: Random) -> Any:
    lines = text.splitlines()
    place = int(rng.integers(1, len(lines)))
    lines[place] = " " * int(rng.integers(1, 7)) + lines[place].lstrip()
    return "\n".join(lines) + "\n", READ


@kind(TEXT)
def bracket_missing(text: str, rng: Random) -> Any:
    places = [i for i, letter in enumerate(text) if letter in '[]{}":']
    place = places[rng.integers(len(places))]
    return text[:place] + text[place + 1 :], READ


@kind(TEXT)
def line_missing(text: str, rng: Random) -> Any:
    lines = text.splitlines()
    del lines[rng.integers(len(lines))]
    return "\n".join(lines) + "\n", READ


@kind(TEXT)
def line_twice(text: str, rng: Random) -> Any:
    lines = text.splitlines()
    place = int(rng.integers(len(lines)))
    return "\n".join([*lines[:place], lines[place], *lines[place:]]) + "\n", READ


@kind(TEXT)
def tag_of_code(text: str, rng: Random) -> Any:
    return text.replace("seed: ", "seed: !!python/object/apply:os.system ['touch made']\n#"), REFUSE


@kind(TEXT)
def laughs(text: str, rng: Random) -> Any:
    bomb = "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12))
    return bomb + text, REFUSE


@kind(TEXT)
def nested(text: str, rng: Random) -> Any:
    depth = int(rng.choice([60, 3000, 100_000]))
    return text + "deep: " + "[" * depth + "]" * depth + "\n", REFUSE


@kind(TEXT)
def endless(text: str, rng: Random) -> Any:
    return text + "# " + "x" * 3_000_000 + "\n", READ


@kind(TEXT)
def second_document(text: str, rng: Random) -> Any:
    return text + "---\n" + text, REFUSE


def misread(tree: Tree, facts: dict[str, Any]) -> Iterator[str]:
    """Where what `check` says of a job is not what another reader finds in it."""
    records = tree["records"]
    if [record["file"] for record in records] != [record["file"] for record in facts["records"]]:
        yield "other files"
    if [record.get("use", "identify") for record in records] != [record["use"] for record in facts["records"]]:
        yield "other uses"
    if tree.get("name") is not None and str(tree["name"]) != facts["name"]:
        yield "another name"
    words = [item if isinstance(item, str) else item["name"] for item in tree["model"]]
    if any(word not in facts["model"] for word in words):
        yield "another model"
    optimizers = tree.get("optimizers") or [{"name": "pso"}]
    runs = [f"{item['name']}-{i}" for item in optimizers for i in range(tree.get("repeats") or 1)]
    if runs != facts["runs"]:
        yield "other runs"
    budget = (tree.get("stop") or {}).get("evaluations")
    first = optimizers[0]
    if budget is None and {"population", "generations"} <= set(first):
        budget = first["population"] * first["generations"]
    if budget is not None and budget * len(runs) != facts["evaluations"]:
        yield "other evaluations"
    for name, setting in (tree.get("parameters") or {}).items():
        rows = [row for row in facts["parameters"] if name.endswith(row["name"]) or row["name"].endswith(name)]
        wanted = setting.get("bounds", setting.get("value"))
        if rows and wanted is not None and not any(same(wanted, row.get("bounds", row.get("value"))) for row in rows):
            yield f"another {name}"


def same(wanted: Any, value: Any) -> bool:
    return value is not None and bool(np.allclose(np.float64(wanted), np.float64(value), rtol=1e-9, atol=0))
