"""Campaigns by name, and what is written down about one beside its files."""

import inspect
import json
import os
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Declared:
    """kind, true effects, {effect: names that are right as well}, what is hidden, and the function that builds it."""

    kind: str
    effects: tuple
    also: dict
    what: str
    build: Callable


def entry(campaigns):
    """The decorator that enters a campaign: kind, and each hidden effect with the names that are right as well."""

    def declare(name, kind, **effects):
        def enter(build):
            what = " ".join(inspect.getdoc(build).split())
            campaigns[name] = Declared(kind, tuple(effects), {k: tuple(v) for k, v in effects.items()}, what, build)
            return build

        return enter

    return declare


def truth(name, declared, sizes, known):
    """What is true of a case; sizes: of sizes.json, known: further entries."""
    also = [other for names in declared.also.values() for other in names]
    out = {"name": name, "kind": declared.kind, "effects": declared.effects, "class": [*declared.effects, *also]}
    out |= {"also_right": declared.also, "what": declared.what, "floors": sizes["floors"]}
    if "floors_each" in sizes:
        out["floors_each"] = sizes["floors_each"]
    return out | known


def keep(home, true):
    """Write truth.json, all at once."""
    part = home / "truth.part"
    part.write_text(json.dumps(true, indent=1) + "\n")
    os.replace(part, home / "truth.json")
