"""Chains of blocks over axes: order, names, and every chain against its slow twin."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lin_lin
from pzt_ident.engine.simulator import Simulator, simulate
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from rig import assert_close, candidates, model, record, response, rounding, triangle
from twins import plain
from twins.blocks import Identity, Relative, Turn

AXIS = ["bouc_wen", "lumped"]
SPAN = np.array([0.0, 100.0])


def noise(axes, samples=150, seed=0):
    return np.random.default_rng(seed).uniform(0, 100, (axes, samples)).cumsum(axis=1) % 97


measured_axes = st.sampled_from([(1, (0,)), (2, (0,)), (2, (1,)), (2, (0, 1)), (3, (0, 2)), (3, (0, 1, 2))])
REST = {"rest_at": (30.0, None, 130.0)}  # of up to three axes
WAYS = [{}, {"run_in": 1}, {"steps": 3}, {"run_in": 1, "steps": 2}, REST, REST | {"steps": 2}]
seeds, periods = st.integers(0, 1000), st.sampled_from(WAYS)


def kind(item):
    """A job has one block of hysteresis and one of mechanics."""
    folder = blocks.folder(item) if isinstance(item, str) else "tests"
    return folder if folder in ("hysteresis", "mechanics") else item


@given(
    chain=st.lists(st.sampled_from([Identity, Turn, *blocks.words()]), max_size=4, unique_by=kind),
    measured=measured_axes,
    seed=seeds,
    more=periods,
)
@settings(deadline=None, max_examples=40, derandomize=True)
def test_every_chain_is_its_blocks_one_after_the_other(chain, measured, seed, more):
    axes, measured = measured
    samples, response = (20, 1e-4) if "bouc_wen_oscillator" in chain else (100, 10.0)
    chain = model(*chain, axes=axes, measured=measured)
    made = record(*noise(axes, samples, seed), measured=measured, **more)
    theta = candidates(chain, SPAN, 3, seed, response)
    expected = np.array([plain.simulate(chain, made, candidate) for candidate in theta])
    assert_close(simulate(chain, made, theta), expected, rounding(chain, made, theta))


TERMS = ["asymmetry", "rate_dependence", "thermal_relaxation"]
AROUND = [*TERMS, "delay", "amplifier_lag", "quadratic_gain", "creep", "cross_coupling"]


@given(st.lists(st.sampled_from(AROUND), unique=True), measured_axes, seeds, periods)
@settings(deadline=None, max_examples=40, derandomize=True)
def test_whatever_stands_around_hysteresis(around, measured, seed, more):
    """A memory that does not run away: |gamma| <= beta."""
    axes, measured = measured
    chain = model("bouc_wen", *around, axes=axes, measured=measured)
    made = record(*noise(axes, 100, seed), measured=measured, **more)
    theta = candidates(chain, SPAN, 3, seed)
    beta, gamma = ([name.endswith(f"bouc_wen.{word}") for name in chain.names] for word in ("beta", "gamma"))
    theta[:, gamma] = np.clip(theta[:, gamma], -theta[:, beta], theta[:, beta])
    expected = np.array([plain.simulate(chain, made, candidate) for candidate in theta])
    assert_close(simulate(chain, made, theta), expected)


def test_blocks_stand_in_the_order_of_the_signal():
    chain = model("lumped", "cross_coupling", "bouc_wen", Identity)
    assert [block.name for block in chain.blocks] == ["identity", "bouc_wen", "cross_coupling", "lumped"]


def test_names_carry_the_axis_only_where_there_are_several():
    assert model(*AXIS).names[:2] == ("bouc_wen.gain", "bouc_wen.alpha")
    assert model(*AXIS, axes=2, measured=[1]).names[:1] == ("bouc_wen.gain",)
    assert model(*AXIS, "viscous_damping", "load_mass", axes=2).names[::4] == (
        "x.bouc_wen.gain",
        "y.bouc_wen.gain",
        "x.lumped.mass",
        "x.lumped.extra_damping",
        "y.lumped.load",
    )
    assert model(*AXIS).names[-1] == "lumped.stiffness"
    assert model("cross_coupling").names == ("x.cross_coupling.ratio", "y.cross_coupling.ratio")
    assert model("cross_coupling", axes=2, measured=[0]).names == ("cross_coupling.ratio",)
    assert model(Turn, axes=3, measured=[0, 1]).names == (
        "x.turn.size_from_y",
        "x.turn.size_from_z",
        "y.turn.size_from_x",
        "y.turn.size_from_z",
    )
    assert model("prandtl_ishlinskii").names[:3] == tuple(
        f"prandtl_ishlinskii.{word}" for word in ("gain", "weight_1", "weight_2")
    )


def test_an_axis_that_is_not_measured_may_have_parameters_of_its_own():
    """y rings as its own mass lets it: what x reads of it is what y alone would read."""
    drive, known = triangle(50), lin_lin.X | {"lumped.damping": 30.0}
    alone = response(AXIS, known | {"lumped.mass": 9.0}, drive, dt=1e-4)
    chain = [blocks[word] for word in (*AXIS, "kinematic_coupling")]
    given = Chain(chain, "xy", (0,), given=("y.lumped.mass", "y.kinematic_coupling.ratio"))
    assert [name for name in given.names if name.startswith("y.")] == ["y.lumped.mass"]
    values = known | {"y.lumped.mass": 9.0, "kinematic_coupling.ratio": 0.1}
    made = record(0 * drive, drive, measured=[0], dt=1e-4)
    theta = np.array([values[name] for name in given.names])
    found = simulate(given, made, theta)[0, 0]
    assert_close(found, 0.1 * alone)
    assert_close(found, plain.simulate(given, made, theta)[0])
    assert np.abs(found - 0.1 * response(AXIS, known, drive, dt=1e-4)).max() > 0.01 * np.ptp(found)


def test_shared_parameters_are_one_for_every_axis():
    chain = [blocks[word] for word in AXIS]
    names = {name for name in Chain(chain, "xy", (0, 1)).names if "beta" not in name}
    shared = Chain(chain, "xy", (0, 1), ["bouc_wen.beta"])
    assert set(shared.names) == names | {"bouc_wen.beta"}
    apart, made = Chain(chain, "xy", (0, 1)), record(*noise(2))
    theta = candidates(shared, SPAN, 5, 3)
    known = dict(zip(shared.names, theta.T, strict=True))
    known |= {"x.bouc_wen.beta": known["bouc_wen.beta"], "y.bouc_wen.beta": known["bouc_wen.beta"]}
    expected = simulate(apart, made, np.array([known[name] for name in apart.names]).T)
    np.testing.assert_array_equal(simulate(shared, made, theta), expected)
    spellings = {entry.name: shared.spellings(entry) for entry in shared.entries}
    assert spellings["bouc_wen.beta"] == ("bouc_wen.beta",)


def test_a_model_of_nothing_passes_the_drive_on():
    x, y = noise(2)
    found = simulate(model(axes=2, measured=[1]), record(x, y, measured=[1]), np.zeros((2, 0)))
    np.testing.assert_array_equal(found, [[y], [y]])


def test_an_axis_without_response_still_couples():
    """It is simulated as far as the coupling, with the parameters of the axis that is measured."""
    x, y = noise(2)
    one = response(["bouc_wen"], lin_lin.X, x), response(["bouc_wen"], lin_lin.X, y)
    chain = model("bouc_wen", "cross_coupling", axes=2, measured=[0])
    known = lin_lin.X | {"cross_coupling.ratio": 0.1}
    found = simulate(chain, record(x, y, measured=[0]), np.array([known[name] for name in chain.names]))
    np.testing.assert_allclose(found[0, 0], one[0] + 0.1 * one[1], rtol=0, atol=1e-12)


def test_blocks_may_ask_for_the_sample_time_and_the_span():
    x, y = noise(2) * [[1], [3]]
    found = simulate(model(Relative, axes=2), record(x, y, dt=0.25), np.zeros((1, 0)))
    np.testing.assert_allclose(found[0], [0.25 * x / np.ptp(x), 0.25 * y / np.ptp(y)], rtol=1e-15)


@pytest.mark.parametrize("count", [1, 23, 24, 25, 70])
def test_any_number_of_candidates(count):
    chain, made = model(*AXIS), record(*noise(1))
    theta = candidates(chain, SPAN, 70, 1)
    all_of_them, squares = simulate(chain, made, theta), Simulator(chain, made).squares(theta)
    np.testing.assert_allclose(simulate(chain, made, theta[:count]), all_of_them[:count], rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(Simulator(chain, made).squares(theta[:count]), squares[:count], rtol=1e-9)


def test_one_candidate_may_be_a_row_alone():
    chain, made = model(*AXIS), record(*noise(1))
    theta = candidates(chain, SPAN, 1, 1)
    for of in (Simulator(chain, made).simulate, Simulator(chain, made).squares, Simulator(chain, made).errors):
        np.testing.assert_array_equal(of(theta[0]), of(theta))


def test_a_perfect_fit_is_not_better_than_perfect():
    chain = model(*AXIS, axes=2)
    theta = candidates(chain, SPAN, 100, 2)
    drives = noise(2)
    for candidate in theta:
        made = record(*drives, response=simulate(chain, record(*drives), candidate)[0] + 3.0)
        squares = Simulator(chain, made).squares(candidate)
        assert np.all((squares >= 0) & (squares <= 1e-12 * (made.response**2).sum(axis=1)))


def test_a_plan_may_serve_several_threads():
    chain, made = model(*AXIS), record(*noise(1, 2000))
    simulator, theta = Simulator(chain, made), candidates(chain, SPAN, 48, 3)
    expected = simulator.squares(theta)
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(simulator.squares, [theta] * 20):
            np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize(("drive", "nanometres"), [("sine", 0.01), ("triangle", 3)])
def test_mechanics_do_not_show_in_slow_data(drive, nanometres):
    """Over Lin & Lin's whole box of m, b and k; the triangle's corners leave some ringing."""
    volts = 65 * (1 - np.cos(np.linspace(0, 2 * np.pi, 2000))) if drive == "sine" else triangle(130)
    static = response(["bouc_wen"], lin_lin.X, volts)
    for mass in (0.15, 0.17):
        for damping in (0, 10):
            for stiffness in (7e7, 8e7):
                box = dict(zip(lin_lin.WORDS, (mass, damping, stiffness), strict=False))
                np.testing.assert_allclose(
                    response(AXIS, lin_lin.X | box, volts), static, rtol=0, atol=1e-3 * nanometres
                )


def test_steady_state_of_an_oversampled_block():
    """A run-in takes the period for a period: one more changes nothing, a shift of the drive shifts the response."""
    drive = 50 * np.sin(2 * np.pi * 3 * np.arange(60) / 60) + 20 * np.cos(2 * np.pi * 7 * np.arange(60) / 60)
    words = ("mass", "damping", "stiffness", "alpha", "beta", "gamma")
    known = dict(zip([f"bouc_wen_oscillator.{w}" for w in words], (2, 300, 5e4, 5e4, 800, 100), strict=True))
    settled = [response(["bouc_wen_oscillator"], known, drive, run_in=n) for n in (20, 21)]
    shifted = response(["bouc_wen_oscillator"], known, np.roll(drive, 13), run_in=20)
    np.testing.assert_allclose(settled[0], settled[1], rtol=0, atol=1e-9 * np.ptp(settled[0]))
    np.testing.assert_allclose(shifted - shifted.mean(), np.roll(settled[0] - settled[0].mean(), 13), atol=1e-5)
