"""The pictures of an optimizer: where it looks, and how fast the loss falls beside plain random search."""

from __future__ import annotations

from functools import cache

import numpy as np

from pzt_ident.atlas.drawing import Curve, Panel, drawing
from pzt_ident.atlas.pictures import MAIN, STRIP, Picture
from pzt_ident.atlas.stage import Array
from pzt_ident.model.registry import optimizers
from pzt_ident.search.loop import Stop, optimize

BUDGET, SEEDS, DRAWN = 2000, 5, 500


def residuals(points: Array) -> Array:
    """Of Rosenbrock's function from -2 to 2 in each coordinate, over the unit cube: (M, P) -> (M, 2 P - 2)."""
    x = 4 * points - 2
    return np.hstack([1 - x[:, :-1], 10 * (x[:, 1:] - x[:, :-1] ** 2)])


def loss(points: Array) -> Array:
    """Their root mean square: (M,)."""
    return np.sqrt(np.mean(residuals(points) ** 2, axis=1))


@cache
def search_pictures(word: str) -> list[Picture]:
    """Candidates in two dimensions, and the loss in four."""
    return [_candidates(word), _losses(word)]


def _run(word: str, dimensions: int, budget: int, seed: int) -> tuple[list[Array], Array, Array]:
    """The candidates, and the evaluations and best loss after each generation."""
    candidates: list[Array] = []

    def evaluated_residuals(points: Array) -> Array:
        candidates.append(points)
        return residuals(points)

    def evaluated_loss(points: Array) -> Array:
        candidates.append(points)
        return loss(points)

    optimizer = optimizers[word].make().with_budget(budget)
    outcome = optimize(optimizer, dimensions, evaluated_loss, seed, Stop(budget), evaluated_residuals)
    return candidates, np.asarray(outcome.history.evaluations, dtype=float), outcome.history.best


def _candidates(word: str) -> Picture:
    points = 4 * np.vstack(_run(word, 2, DRAWN, 3)[0])[:DRAWN] - 2
    dots = Curve("dots", *points.T)
    x = np.linspace(-1.42, 1.42, 60)
    panel = Panel([Curve("bare", x, x**2), dots], "second coordinate", MAIN + STRIP)
    title = f"The first {DRAWN} candidates in Rosenbrock's valley (dashed); its minimum is at (1, 1)"
    return Picture(drawing([panel], "first coordinate", f"{word}-loop", title), title, 1.0, f"{word}-loop")


def _losses(word: str) -> Picture:
    grid = np.arange(50.0, BUDGET + 1, 50)
    curves = [Curve("bare", grid, random_search()), Curve("with", grid, _median(word))]
    panel = Panel(curves, "best loss, median of five searches", MAIN + STRIP, True)
    title = "Rosenbrock's function in four dimensions; dashed: random search"
    return Picture(drawing([panel], "evaluations", f"{word}-steps", title), title, 1.0, f"{word}-steps")


def _median(word: str) -> Array:
    grid = np.arange(50, BUDGET + 1, 50)
    rows = []
    for seed in range(SEEDS):
        _, evaluations, best = _run(word, 4, BUDGET, seed)
        place = np.searchsorted(evaluations, grid, side="right") - 1
        rows.append(np.where(place >= 0, best[np.maximum(place, 0)], np.nan))
    return np.median(np.array(rows), axis=0)


@cache
def random_search() -> Array:
    """The same of points drawn evenly."""
    losses = [loss(np.random.default_rng(seed).random((BUDGET, 4))) for seed in range(SEEDS)]
    return np.median(np.minimum.accumulate(losses, axis=1), axis=0)[49::50]
