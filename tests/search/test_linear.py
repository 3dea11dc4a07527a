"""Parameters that the response is linear in: the free density of the plays against the one that made the data."""

import dataclasses
import json
import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.special import erf

import smith
from pzt_ident.data.notation import ranges
from pzt_ident.engine import simulator
from pzt_ident.engine.amounts import Amounts
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from pzt_ident.report.page import write_report
from pzt_ident.run.identify import run
from pzt_ident.run.place import Local
from pzt_ident.search import sandwich
from pzt_ident.search.descent import polish
from pzt_ident.search.linear import Linear, differences, solve
from pzt_ident.search.problem import Problem
from pzt_ident.search.stencil import stencil
from pzt_ident.search.uncertainty import estimates
from rig import path, record, response
from twins.homogenized_energy_twin import quantiles
from twins.prandtl_ishlinskii_twin import play

FIELD = path(0, 8000, 0, 6000, 1000, 5000, 2000, 4000, 0, 3000, points=60)
NOISE = 1e-7
NODES, REACH = 24, 6000.0
HALVES = REACH * (np.arange(NODES) + 0.5) / NODES
FREE = blocks["homogenized_energy"].make(density="free", nodes=NODES)


@pytest.fixture(scope="module")
def measured():
    y = response(["homogenized_energy"], smith.A, FIELD)
    return record(FIELD, response=[y + np.random.default_rng(4).normal(0, NOISE, y.size)])


def problem(measured, *behind, smoothness=1e-3, reach=REACH, **more):
    fixed = {"poled": 1e6, "reach": reach, "smoothness": smoothness} | more
    specs = {f"homogenized_energy.{word}": SimpleNamespace(bounds=None, value=value) for word, value in fixed.items()}
    return Problem(Chain([FREE, *(blocks[word] for word in behind)], ["x"], [0]), [measured], specs)


def at(made, interaction):
    return made.unit_point({"homogenized_energy.interaction": interaction})


def weights(made, point):
    return made.parameters(point)[0][[name.startswith("homogenized_energy.weight") for name in made.model.names]]


def changes(residuals):
    """Residuals of candidates as `solve` asks for them."""
    return lambda values: (differences(len(values)) @ residuals(values)).T


def test_it_is_one_non_negative_least_squares_problem(measured):
    """Of gain and weights at one width, written out."""
    made = problem(measured, smoothness=1e-9)
    memories = np.array([play([1e6, *FIELD], half)[1:] for half in HALVES]).T
    columns = np.column_stack([FIELD, erf(memories / np.sqrt(2) / 6120)])
    columns -= columns.mean(axis=0)
    y = measured.response[0] - measured.response[0].mean()
    scale = np.linalg.norm(columns, axis=0) + 1e-9
    expected = nnls(columns / scale, y)[0] / scale
    rmse = np.sqrt(np.mean((y - columns @ expected) ** 2))
    assert made.loss(at(made, 6120))[0] == pytest.approx(rmse, rel=1e-5)
    assert made.parameters(at(made, 6120))[0, 0] == pytest.approx(expected[0], rel=1e-3)


def test_the_residual_is_the_noise_at_the_true_interaction(measured):
    made = problem(measured)
    point, _ = polish(made, at(made, 9000))
    assert made.physical(point)[0, 0] == pytest.approx(6120, rel=0.05)
    assert made.loss(point)[0] == pytest.approx(NOISE, rel=0.06)
    wrong = [made.loss(at(made, width))[0] for width in (3000, 12000)]
    assert min(wrong) > 1.3 * NOISE


def test_polarization_and_strain_share_a_density(measured):
    """D = 3 (P less its linear part) + c E: the ratio is found, and the weights are those of both together."""
    field_part = 4e-9 * FIELD
    both = [measured.response[0], 3 * response(["homogenized_energy"], smith.A, FIELD) + field_part]
    both[1] += np.random.default_rng(5).normal(0, 3 * NOISE, FIELD.size)
    pair = dataclasses.replace(record(FIELD, FIELD, response=both), response_units=("uC/cm2", "um"))
    model = Chain([blocks["homogenized_energy"].make(density="shared", nodes=NODES)], ["p", "d"], [0, 1])
    fixed = {"poled": 1e6, "reach": REACH, "smoothness": 1e-3}
    specs = {f"homogenized_energy.{word}": SimpleNamespace(bounds=None, value=value) for word, value in fixed.items()}
    made = Problem(model, [pair], specs, [NOISE, 3 * NOISE])
    assert made.names == ("homogenized_energy.interaction", "d.homogenized_energy.ratio")
    assert made.units == ("V", "um/(uC/cm2)")
    point, _ = polish(made, np.array([0.5, 0.7]))
    width, ratio = made.physical(point)[0]
    assert width == pytest.approx(6120, rel=0.05) and ratio == pytest.approx(3e4, rel=0.01)
    assert made.loss(point)[0] == pytest.approx(1, rel=0.06)
    alone = problem(measured)
    np.testing.assert_allclose(weights(made, point)[:14].sum(), weights(alone, at(alone, 6120))[:14].sum(), rtol=0.02)


def test_nodes_that_no_record_moved_are_said_to_be(measured):
    """From the poled state they move up to half the span of the field, 4 kV/m."""
    made = problem(measured)
    found = {item.at[0]: item for item in estimates(made, at(made, 6120))[0] if item.at}
    np.testing.assert_allclose(list(found), HALVES)
    for half, item in found.items():
        assert (item.verdict == "not moved") == (half >= 4000)
        assert item.at[1] == "V" and (item.value == 0 or half < 4000)


def test_errors_of_the_weights_cover_the_scatter(measured):
    """Over repeated noise; two standard errors hold most of them."""
    y = response(["homogenized_energy"], smith.A, FIELD)
    found = []
    for seed in range(12):
        again = record(FIELD, response=[y + np.random.default_rng(seed).normal(0, NOISE, y.size)])
        made = problem(again)
        found.append([(i.value, i.standard_error or 0) for i in estimates(made, at(made, 6120))[0] if i.at][2:12])
    values, errors = np.moveaxis(np.array(found), 2, 0)
    assert 0.4 < np.median(values.std(axis=0) / np.median(errors, axis=0)) < 2.5


def test_a_smooth_density_is_the_true_one_on_average(measured):
    """Single weights scatter; with the prior the mass below a field is right to some percent, and smooth."""
    rough, smooth = (weights(made, at(made, 6120)) for made in (problem(measured, smoothness=s) for s in (1e-9, 1e-2)))
    fields = 2400 * np.exp(0.887 * quantiles(4000))
    true = smith.REMANENCE * np.mean((fields > HALVES[3] - 125) & (fields < HALVES[12] + 125))
    assert smooth[3:13].sum() == pytest.approx(true, rel=0.1)
    assert np.abs(np.diff(smooth[:14], 2)).sum() < 0.3 * np.abs(np.diff(rough[:14], 2)).sum()


def test_an_inverted_response_has_weights_below_zero(measured):
    turned = record(FIELD, response=-measured.response)
    made, upright = problem(turned), problem(measured)
    np.testing.assert_allclose(weights(made, at(made, 6120)), -weights(upright, at(upright, 6120)), atol=1e-12)


def test_a_linear_block_behind_is_in_the_columns(measured):
    known = smith.A | {"lumped.mass": 0.2, "lumped.damping": 900.0, "lumped.stiffness": 1e6}
    behind = record(FIELD, response=[response(["homogenized_energy", "lumped"], known, FIELD)])
    specs = {name: SimpleNamespace(bounds=None, value=value) for name, value in known.items() if "lumped" in name}
    specs |= {"homogenized_energy.poled": SimpleNamespace(bounds=None, value=1e6)}
    made = Problem(Chain([FREE, blocks["lumped"]], ["x"], [0]), [behind], specs)
    assert made.loss(at(made, 6120))[0] < 2e-3 * np.ptp(behind.response)


def test_what_is_bent_behind_is_relinearised():
    """y = q + 0.1 q^3 of two columns: found to rounding, though no pass is exact."""
    columns, truth = np.random.default_rng(0).normal(size=(2, 50)), np.array([0.4, 0.7])
    bent = lambda values: (q := values @ columns) + 0.1 * q**3  # noqa: E731
    found = solve(changes(lambda values: bent(values) - bent(truth)), np.full(2, 1e-3), [], [])
    np.testing.assert_allclose(found.values, truth, rtol=1e-3)


@pytest.mark.parametrize("periods", [3, 6, 12])
def test_a_grating_behind_is_read_where_the_stage_is_and_not_by_its_slope_at_rest(measured, periods):
    """The error is as steep as six tenths of the reading: a candidate that has it leaves little more than the noise."""
    stroke = np.ptp(measured.response[0])
    pitch, sine = stroke / periods, 0.6 * stroke / (2 * np.pi * periods)
    read = measured.response + sine * np.sin(2 * np.pi * measured.response / pitch)
    made = problem(dataclasses.replace(measured, response=read), "encoder_cyclic_error")
    known = {"sine": sine, "cosine": 0.0, "pitch": pitch}
    point = made.unit_point(
        {"homogenized_energy.interaction": 6120}
        | {f"encoder_cyclic_error.{word}": value for word, value in known.items()}
    )
    assert made.loss(point)[0] < 3 * NOISE


@pytest.mark.parametrize("bend", [0.3, 1.0, 3.0, -0.3, -1.0])
def test_a_pass_that_goes_too_far_is_shortened(bend):
    """y = q + bend q^2 of ten columns that are nearly the same: what is left falls with every pass."""
    columns = np.random.default_rng(1).normal(size=(1, 50)) + 0.1 * np.random.default_rng(2).normal(size=(10, 50))
    bent = lambda values: (q := values @ columns) + bend * q**2  # noqa: E731
    target = bent(np.full(10, 0.2)) + np.random.default_rng(3).normal(0, 0.3, 50)
    left = [np.linalg.norm(target)]
    for passes in range(1, 7):
        found = solve(changes(lambda values: bent(values) - target), np.full(10, 0.2), [], [], passes)
        left.append(np.linalg.norm(bent(found.values) - target))
    assert np.all(np.diff(left) <= 1e-12)


@pytest.mark.parametrize(("behind", "most"), [((), 1 + 1e-9), (("quadratic_gain.displacement",), 1.5)])
def test_few_passes_tell_candidates_from_each_other(measured, behind, most):
    """With nothing behind they are exact; behind what bends the response they leave more, but in the same order."""
    made = problem(measured, *behind)
    points = np.full((7, made.dimensions), 0.52)
    points[:, made.names.index("homogenized_energy.interaction")] = np.linspace(0.05, 0.95, 7)
    rough, exact = made.rough().loss(points), made.loss(points)
    assert not behind or not np.allclose(rough, exact, rtol=1e-9, atol=0)
    np.testing.assert_array_equal(np.argsort(rough), np.argsort(exact))
    assert np.all(np.abs(np.log(rough / exact)) <= np.log(most))


@pytest.mark.parametrize("behind", [(), ("quadratic_gain.displacement",)])
def test_what_is_sought_from_beside_is_what_is_sought_from_nothing(measured, behind):
    """In half the passes; beside its own place it is there already."""
    made = problem(measured, *behind)
    points = np.full((3, made.dimensions), 0.52)
    points[:, made.names.index("homogenized_energy.interaction")] = [0.5, 0.51, 0.53]
    begun = made.begun_at(points[0])
    np.testing.assert_array_equal(begun.parameters(points[0]), made.parameters(points[0]))
    np.testing.assert_allclose(begun.loss(points), made.loss(points), rtol=1e-3)
    assert np.all(begun.loss(points) <= (1 + 1e-6) * made.rough().loss(points))


@pytest.mark.parametrize(("reach", "says"), [(5e6, "nothing switches: the response is linear"), (5.0, "at once")])
def test_a_density_far_from_the_drive_is_refused(measured, reach, says):
    with pytest.raises(InputError, match=says) as error:
        problem(measured, reach=reach)
    assert error.value.where == "homogenized_energy.reach" and "50 V/m" in error.value.remedy


def test_a_value_for_a_weight_is_taken_as_it_is(measured):
    made = problem(measured, weight_3=2e-6)
    assert weights(made, at(made, 6120))[2] == 2e-6
    assert made.linear.columns.size == NODES


JOB = """\
name: density
records: [{{file: loops.csv, use: identify}}]
channels:
  time: "time [s]"
  axes:
    x: {{drive: "E [V/m]", response: "x [um]"}}
model: [{{name: homogenized_energy, density: free, nodes: 24}}]
parameters: {parameters}
optimizers: [{{name: least_squares, budget: 30}}]
"""


def test_from_a_job_to_the_report_and_back(measured, tmp_path):
    """What was found, given as values, simulates the same; result and report say which nodes no record moved."""
    rows = np.column_stack([measured.time, FIELD, 1e6 * measured.response[0]])
    np.savetxt(tmp_path / "loops.csv", rows, delimiter=",", header="time [s],E [V/m],x [um]", comments="", fmt="%.9g")
    fixed = {"homogenized_energy.poled": {"value": 1e6}, "homogenized_energy.reach": {"value": REACH}}
    folder = run(Job.from_text(JOB.format(parameters=json.dumps(fixed)), tmp_path), tmp_path / "out", place=Local(1))
    found = json.loads((folder / "result.json").read_text())["best"]
    assert found["parameters"]["homogenized_energy.interaction"]["value"] == pytest.approx(6120, rel=0.05)
    still = [name for name, entry in found["parameters"].items() if entry["verdict"] == "not moved"]
    assert still == [f"homogenized_energy.weight_{k}" for k in range(17, 25)]
    page = write_report(folder).read_text()
    assert "No record excites the 8 values at 4125 to 5875" in page.replace("\u2009", "").replace(",", "")
    assert (folder / "figures" / "density-homogenized-energy-weight-180mm.svg").exists()
    again = fixed | {name: {"value": entry["value"]} for name, entry in found["parameters"].items()}
    width = again["homogenized_energy.interaction"]["value"]
    again["homogenized_energy.interaction"] = {"bounds": [width * (1 - 1e-9), width * (1 + 1e-9)]}
    second = run(Job.from_text(JOB.format(parameters=json.dumps(again)), tmp_path), tmp_path / "again")
    rmse = json.loads((second / "result.json").read_text())["best"]["rmse"]["identify"]
    assert rmse == pytest.approx(found["rmse"]["identify"], rel=1e-9)


def test_an_effect_that_the_form_has_no_term_for_is_refused():
    text = JOB.format(parameters="{}") + "effects: [thermal_relaxation]\n"
    Job.from_text(text.replace(", density: free, nodes: 24", ""))
    with pytest.raises(InputError, match="no block of this model has a term for 'thermal_relaxation'"):
        Job.from_text(text)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("density: free, nodes", "nodes", "only its form free or shared has it"),
        (
            "parameters: {}",
            "parameters: {homogenized_energy.spread: {value: 1}}",
            "is not in the form of 'homogenized_en",
        ),
    ],
)
def test_what_another_form_has_is_said_to_be_its(old, new, says):
    with pytest.raises(InputError) as error:
        Job.from_text(JOB.format(parameters="{}").replace(old, new))
    assert says in str(error.value)


def test_counted_names_in_a_row_are_said_in_one():
    assert ranges(["a.w_1", "a.w_2", "a.w_3", "b.w_4", "a.w_9", "c"]) == ["a.w_1 to a.w_3", "b.w_4", "a.w_9", "c"]


def test_neighbours_are_smoothed_by_their_second_differences():
    """Normal equations by hand: the weight counts in squares of the middle one of the columns' sizes, 2."""
    sizes, measured, weight = np.diag([1.0, 2.0, 4.0]), np.array([3.0, 1.0, 20.0]), 0.3
    bend = np.array([1.0, -2.0, 1.0])
    found = solve(changes(lambda values: values @ sizes - measured), np.ones(3), [np.arange(3)], [weight])
    expected = np.linalg.solve(sizes @ sizes + weight * 2**2 * np.outer(bend, bend), sizes @ measured)
    assert expected.min() > 0
    np.testing.assert_allclose(found.values, expected, rtol=1e-9)
    np.testing.assert_allclose(
        solve(changes(lambda values: values @ sizes - measured), np.ones(3), [], []).values, [3, 0.5, 5]
    )


def test_each_curve_is_smoothed_by_its_own_weight():
    """Two curves of three values each, of which the second is not smoothed."""
    measured = np.array([3.0, 0.5, 5.0, 3.0, 0.5, 5.0])
    solution = solve(changes(lambda values: values - measured), np.ones(6), [np.arange(3), np.arange(3, 6)], [1e9, 0.0])
    np.testing.assert_allclose(np.diff(solution.values[:3], 2), 0, atol=1e-6)
    np.testing.assert_allclose(solution.values[3:], measured[3:])


def test_what_nothing_shows_is_zero():
    """As where a block behind the density lets nothing through."""
    found = solve(
        changes(lambda values: np.ones((len(values), 5))), np.ones(6), [np.arange(3), np.arange(3, 6)], [1, 1]
    )
    np.testing.assert_array_equal(found.values, 0)


def test_a_free_density_on_two_axes_has_a_smoothness_of_each():
    block = blocks["homogenized_energy"].make(density="free")
    chain = Chain([block], ["x", "y"], [0, 1])
    columns = [i for i, entry in enumerate(chain.entries) if entry.parameter.linear]
    linear = Linear(chain, columns, np.ones(len(columns)), lambda theta: theta)
    names = [chain.names[column] for column in linear._weights]
    assert names == ["x.homogenized_energy.smoothness", "y.homogenized_energy.smoothness"]


def test_what_is_solved_for_follows_to_first_order(measured):
    """Half the way from a point, a quarter of the error."""
    exact = problem(measured)
    point = at(exact, 5000)
    near = exact.along(exact.tangent(point, sampled=True))
    assert near.residuals(point) == pytest.approx(exact.residuals(point), abs=1e-9 * exact.loss(point)[0])

    def error(step):
        moved = point + step * np.ones(point.size)
        return np.linalg.norm(near.residuals(moved) - exact.residuals(moved))

    assert error(5e-3) / error(2.5e-3) == pytest.approx(4, rel=0.3)


@pytest.mark.parametrize("behind", [(), ("drift",), ("quadratic_gain",)])
def test_what_is_gathered_is_what_is_held(measured, behind):
    """Rotated residuals have the inner products of the samples, and stretches are the samples."""
    exact = problem(measured, *behind)
    point = np.full(exact.dimensions, 0.4)
    near = exact.along(exact.tangent(point, sampled=True))
    points, weights = stencil(point)
    held = near.residuals(points)
    gathered = near.rotated_residuals(points)
    np.testing.assert_allclose(gathered @ gathered.T, held @ held.T, rtol=1e-9)
    stretches = np.hstack([rows for _, rows in exact.samples(point)])
    np.testing.assert_allclose(stretches[0], held[0], atol=1e-12 * np.abs(measured.response).max())
    slopes = weights[1:] @ held
    np.testing.assert_allclose(stretches[1:], slopes, atol=1e-5 * np.abs(slopes).max())


def test_amounts_of_a_record_are_solved_for_beside_a_density(measured, monkeypatch):
    """A ripple on the field, which the density bends: both together end at the noise, and are never solved for anew in
    each of the density's columns."""
    wave = 200 * np.sin(2 * np.pi * 0.03 * np.arange(FIELD.size) + 1)
    moved = response(["homogenized_energy"], smith.A, FIELD + wave)
    made = record(FIELD, response=[moved + np.random.default_rng(5).normal(0, NOISE, moved.size)])
    values = {"poled": 1e6, "reach": REACH, "smoothness": 1e-3}
    specs = {f"homogenized_energy.{word}": SimpleNamespace(bounds=None, value=value) for word, value in values.items()}
    specs["periodic_disturbance.frequency"] = SimpleNamespace(bounds=None, value=0.03 / made.dt)
    rippled = Problem(Chain([blocks["periodic_disturbance.ripple"], FREE], ["x"], [0]), [made], specs)
    together, products = [], Amounts._products
    monkeypatch.setattr(Amounts, "_products", lambda *args: together.append(len(args[1])) or products(*args))
    loss = rippled.loss(at(rippled, 6120))[0]
    assert loss == pytest.approx(problem(measured).loss(at(problem(measured), 6120))[0], rel=0.1)
    assert max(together) == 1


def test_no_column_of_a_long_record_is_held(monkeypatch):
    for module in (simulator, sandwich):
        monkeypatch.setattr(module, "STRETCH", 256)
    field = np.tile(FIELD, 20)
    made = problem(record(field, response=[response(["homogenized_energy"], smith.A, field)]))
    made.loss(at(made, 6120))
    point = at(made, 9000)
    tracemalloc.start()
    made.best(point[None], point)
    made.equations(point)
    estimates(made, point)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8 * field.size * NODES / 2
