"""Laws over the registry: what is an optimizer, is tested by being there."""

import os
import random
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from pzt_ident.cli.commands import main
from pzt_ident.errors import InputError
from pzt_ident.model.description import description_of
from pzt_ident.model.registry import optimizers
from pzt_ident.search.loop import Stop, minimize, optimize

WORDS = optimizers.words()
few = settings(max_examples=5, deadline=None)
seeds = st.integers(0, 2**32 - 1)


def bowl(points, centre=0.3):
    return np.sum((points - centre) ** 2, axis=1)


def walk(word, dimensions, seed, evaluations=300, function=bowl, **more):
    """The points that were tried, and the outcome."""
    tried = []

    def watched(points):
        tried.append(points.copy())
        return function(points)

    optimizer = optimizers[word].make().with_budget(evaluations)
    return tried, optimize(optimizer, dimensions, watched, seed, Stop(evaluations), **more)


@pytest.mark.parametrize("word", WORDS)
@given(dimensions=st.integers(1, 10), seed=seeds)
@few
def test_stays_in_the_cube_and_the_budget(word, dimensions, seed):
    tried, outcome = walk(word, dimensions, seed)
    points = np.vstack(tried)
    assert points.shape == (300, dimensions)
    assert ((points >= 0) & (points <= 1)).all()
    assert outcome.evaluations == 300
    np.testing.assert_array_equal(outcome.point, points[np.argmin(bowl(points))])


@pytest.mark.parametrize("word", WORDS)
def test_is_a_function_of_its_seed_alone(word):
    first, again, other = (np.vstack(walk(word, 3, seed)[0]) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("word", WORDS)
def test_leaves_the_global_random_states_alone(word):
    np.random.seed(1)  # noqa: NPY002
    random.seed(1)
    before = np.random.get_state()[1].tobytes(), random.getstate()  # noqa: NPY002
    walk(word, 3, 5)
    assert (np.random.get_state()[1].tobytes(), random.getstate()) == before  # noqa: NPY002


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("bad", [np.inf, np.nan])
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_survives_failures(word, bad, share):
    """Half of the cube fails, or all of it."""
    tried, outcome = walk(word, 3, 5, 400, lambda x: np.where(x[:, 0] <= share, bad, bowl(x, 0.7)))
    assert np.isfinite(np.vstack(tried)).all()
    assert outcome.evaluations == 400
    assert outcome.loss < 0.1 if share < 1 else outcome.loss == np.inf


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("centre", [0.3, 0.0, 1.0])
def test_finds_the_bottom_of_a_bowl(word, centre):
    """Inside the cube, and in its corners."""
    loss = walk(word, 4, 7, 6000, lambda x: bowl(x, centre))[1].loss
    assert loss < (1e-4 if optimizers[word].convergent else 1e-2)


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("cut", [1, 2, 7])
def test_goes_on_from_the_recorded_losses(word, cut):
    recorded = []
    whole, outcome = walk(word, 3, 5, 1200, callback=lambda state: recorded.append(state.losses.copy()))
    rest, again = walk(word, 3, 5, 1200, earlier_losses=recorded[:cut])
    np.testing.assert_array_equal(np.vstack(rest), np.vstack(whole[cut:]))
    assert (again.loss, *again.point) == (outcome.loss, *outcome.point)


@pytest.mark.parametrize("word", WORDS)
def test_a_wrong_setting_names_itself(word):
    with pytest.raises(InputError, match=rf"{word}: unknown setting 'papulation'"):
        optimizers[word].make(papulation=3)


@pytest.mark.parametrize("word", WORDS)
def test_says_where_it_comes_from(word):
    chosen = optimizers[word]
    assert chosen.name == word
    assert any(character.isdigit() for character in chosen.source)
    assert len(chosen.__doc__.splitlines()[0]) > 20


@pytest.mark.parametrize("word", WORDS)
def test_says_whether_it_converges(word):
    shown = CliRunner().invoke(main, ["show", word]).stdout
    assert ("does not converge" in shown) == (not optimizers[word].convergent)
    assert description_of(word)["convergent"] == optimizers[word].convergent


@pytest.mark.parametrize("word", [word for word in WORDS if optimizers[word].wants == "residuals"])
def test_residuals_are_worth_their_while(word):
    """Rosenbrock's function as the sum of squares that it is, in a tenth of the evaluations."""
    x = lambda cube: 4 * cube - 2  # noqa: E731
    residuals = lambda cube: np.column_stack([10 * (x(cube)[:, 1] - x(cube)[:, 0] ** 2), 1 - x(cube)[:, 0]])  # noqa: E731
    losses = lambda cube: np.linalg.norm(residuals(cube), axis=1)  # noqa: E731
    optimizer = optimizers[word].make().with_budget(300)
    assert optimize(optimizer, 2, losses, 3, Stop(300), residuals=residuals).loss < 1e-9


def test_writes_nothing_and_needs_no_place_to_write(tmp_path):
    """pyswarms would write report.log into the working directory, and DEAP and pycma know such habits too."""
    code = (
        "from pzt_ident.model.registry import optimizers; from pzt_ident.search.loop import minimize\n"
        "for word in optimizers.words(): minimize(lambda x: float(x @ x), [(-1, 1)] * 2, word, evaluations=80)\n"
        "import logging; assert not logging.getLogger().handlers, logging.getLogger().handlers"
    )
    tmp_path.chmod(0o555)
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    assert done.stdout == done.stderr == ""
    assert not list(tmp_path.iterdir())


def test_two_bbob_functions_are_solved():
    """A slice of experiments/bbob: sphere and separable ellipsoid, to 1e-8."""
    cocoex = pytest.importorskip("cocoex")
    for number in (1, 2):
        problem = cocoex.BareProblem("bbob", number, 5, 1)
        found = minimize(lambda x, p=problem: p(x), [(-5, 5)] * 5, "cma_es", seed=2, evaluations=5000)
        assert found.loss - problem.best_value() < 1e-8
