"""The loss, its gradient and what the data say of each parameter, on data made by the model itself."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import simulate
from pzt_ident.errors import InputError
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.search.descent import polish
from pzt_ident.search.loop import Stop, optimize
from pzt_ident.search.problem import Problem
from pzt_ident.search.uncertainty import estimates

TRUTH = {"bouc_wen.gain": 0.082, "bouc_wen.alpha": 0.56, "bouc_wen.beta": 0.015, "bouc_wen.gamma": 0.055}
MECHANICS = {"lumped.mass": 0.16, "lumped.damping": 100.0, "lumped.stiffness": 7e7}
NONE = {"lumped.load": 0.0, "lumped.extra_damping": 0.0, "lumped.cubic": 0.0}
TWO = {"axes": ("x", "y"), "drive_units": ("V", "V"), "response_units": ("um", "uC/cm2")}


def spec(bounds=None, value=None):
    return SimpleNamespace(bounds=bounds, value=value)


def made(words, truth, noise=0.0, offset=3e-6, **more):
    """A problem whose records were simulated with `truth`."""
    t = np.arange(4000) / 1000
    drives = {"identify": 65 * (1 - np.cos(2 * np.pi * t)), "validate": 50 * np.abs(np.sin(7 * t)) * t / 4}
    model = Chain([blocks[word] for word in words], ["x"], [0])
    rng = np.random.default_rng(5)
    records = []
    for use, u in drives.items():
        blank = Record(use, use, 1e-3, u[None], np.zeros((1, u.size)) + u * 1e-7, response_units=("um",), **more)
        si = [(truth | NONE)[name] * (1e-6 if name.endswith("gain") else 1) for name in model.names]
        y = simulate(model, blank, np.array([si]))[0] + offset + rng.normal(0, noise, (1, u.size))
        records.append(Record(use, use, 1e-3, u[None], y, response_units=("um",), **more))
    return model, records


def test_the_truth_has_no_error_whatever_the_offset():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records)
    point = problem.unit_point(TRUTH)
    assert problem.units == ("um/V", "1", "1/V", "1/V")
    assert problem.loss(point)[0] < 1e-11
    assert problem.loss(point, "validate")[0] < 1e-11


def test_loss_is_the_norm_of_the_residuals():
    model, records = made(["bouc_wen", "lumped"], TRUTH | MECHANICS, noise=1e-8, settle=500)
    problem = Problem(model, records)
    points = np.random.default_rng(1).uniform(size=(30, problem.dimensions))
    residuals = problem.residuals(points)
    assert residuals.shape == (30, 3500) == (30, problem.scored)
    np.testing.assert_allclose(np.linalg.norm(residuals, axis=1), problem.loss(points), rtol=1e-9)


def test_sizes_weigh_the_axes():
    drive = 65 * (1 - np.cos(np.arange(500) / 30))
    model = Chain([blocks["bouc_wen"]], "xy", (0, 1), ["bouc_wen.alpha", "bouc_wen.beta", "bouc_wen.gamma"])
    record = Record("r", "identify", 1e-3, np.array([drive, drive]), np.array([drive * 1e-7, drive * 1e-3]), **TWO)
    sizes = np.array([1e-9, 1e-4])
    problem, points = Problem(model, [record], {}, sizes), np.random.default_rng(2).uniform(size=(4, 5))
    expected = np.sqrt(np.mean((problem.by_axis(points) / sizes) ** 2, axis=1))
    np.testing.assert_allclose(problem.loss(points), expected, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(problem.residuals(points), axis=1), expected, rtol=1e-9)


def test_a_term_is_searched_for_where_its_effect_is_listed():
    model, records = made(["bouc_wen", "lumped", "load_mass"], TRUTH | MECHANICS)
    problem = Problem(model, records)
    column = problem.names.index("lumped.load")
    assert (problem.lower[column], problem.upper[column], problem.units[column]) == (
        *blocks["lumped"].load.bounds,
        "kg",
    )
    assert "lumped.extra_damping" not in problem.names
    without, records = made(["bouc_wen", "lumped"], TRUTH | MECHANICS)
    assert "lumped.load" not in Problem(without, records).names


def test_bounds_may_be_multiples_of_a_power_of_a_span():
    model, records = made(["bouc_wen", "lumped", "cubic_stiffness"], TRUTH | MECHANICS)
    problem = Problem(model, records)
    span = np.ptp(records[0].response) * 1e6
    assert problem.units[problem.names.index("lumped.cubic")] == "1/um^2"
    assert problem.upper[problem.names.index("lumped.cubic")] == pytest.approx(
        blocks["lumped"].cubic.bounds[1] / span**2
    )


def test_relative_bounds_are_multiples_of_the_spans():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records)
    span = np.ptp(records[0].response) * 1e6 / np.ptp(records[0].drive)
    assert problem.upper[0] == pytest.approx(blocks["bouc_wen"].gain.bounds[1] * span)


def test_a_job_narrows_and_fixes():
    model, records = made(["bouc_wen", "lumped"], TRUTH | MECHANICS)
    specs = {
        "bouc_wen.gain": spec((0.05, 0.1)),
        "lumped.mass": spec(value=0.16),
        "x.lumped.stiffness": spec(value=7e7),
    }
    problem = Problem(model, records, specs)
    assert "lumped.mass" not in problem.names and "lumped.stiffness" not in problem.names
    assert (problem.lower[0], problem.upper[0]) == (0.05, 0.1)
    assert problem.loss(problem.unit_point(TRUTH | MECHANICS))[0] < 1e-11


def test_jacobian_is_the_derivative():
    model, records = made(["bouc_wen"], TRUTH, noise=1e-8)
    problem = Problem(model, records)
    point = problem.unit_point(TRUTH) + 0.01
    step = 1e-3 * np.array([1.0, -1, 1, 1])
    change = problem.residuals(point + step)[0] - problem.residuals(point - step)[0]
    assert np.linalg.norm(2 * problem.jacobian(point) @ step - change) < 1e-3 * np.linalg.norm(change)


def test_polish_finds_the_truth_from_nearby():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records)
    point, spent = polish(problem, np.clip(problem.unit_point(TRUTH) * 1.2, 0, 1))
    np.testing.assert_allclose(problem.physical(point)[0], list(TRUTH.values()), rtol=1e-4)
    assert 0 < spent < 2000


def test_a_failed_simulation_is_infinite_and_counted():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records, {"bouc_wen.beta": spec((-1e3, 1e3))})
    bad = problem.unit_point(TRUTH)
    bad[2] = 0.0
    assert problem.loss(np.vstack([bad, problem.unit_point(TRUTH)]))[0] == np.inf
    assert np.isinf(problem.residuals(bad)).all()
    assert problem.failed == 2


def test_the_loss_rises_to_infinity_and_never_falls_back():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records, {"bouc_wen.beta": spec((-1e3, 1e3))})
    points = np.tile(problem.unit_point(TRUTH), (20_000, 1))
    points[:, 2] -= np.linspace(0, 1e-3, len(points))
    losses = problem.loss(points)
    assert losses[0] < 1e-9 < 1e140 < losses[np.isfinite(losses)].max()
    assert losses[-1] == np.inf
    tail = losses[np.argmax(losses > 1) :]
    assert (tail[1:] >= tail[:-1]).all()


def test_the_jacobian_beside_a_failed_simulation_is_one_sided():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records, {"bouc_wen.beta": spec((-1e3, 1e3))})
    fails, holds = problem.unit_point(TRUTH), problem.unit_point(TRUTH)
    fails[2] = 0.0
    while (holds - fails).max() > 1e-6:
        middle = (fails + holds) / 2
        fails, holds = (middle, holds) if np.isinf(problem.loss(middle)[0]) else (fails, middle)
    jacobian = problem.jacobian(holds)
    assert np.isfinite(jacobian).all()
    assert (np.abs(jacobian[:, [0, 2]]).max(axis=0) > 0).all()
    assert np.isfinite(problem.loss(polish(problem, holds)[0])[0])


def turned(records, word):
    """The least loss of a model on the records and on their responses turned round."""
    for sign in (1, -1):
        signed = [dataclasses.replace(record, response=sign * record.response) for record in records]
        problem = Problem(Chain([blocks[word]], ["x"], [0]), signed)
        found = optimize(optimizers["pso"].make(), problem.dimensions, problem.loss, 1, Stop(3000))
        yield problem, problem.loss(polish(problem, found.point)[0])[0]


@pytest.mark.parametrize(("word", "apart"), [("bouc_wen", 1e-3), ("prandtl_ishlinskii", 1e-3), ("domain_wall", 1e-2)])
def test_an_inverting_stage_is_identified_as_well_as_an_upright_one(word, apart):
    """Domain walls are another model than that of the stage, and have minima beside each other."""
    _, records = made(["bouc_wen"], TRUTH, noise=2e-8)
    (upright, loss), (inverting, turned_loss) = turned(records, word)
    assert turned_loss == pytest.approx(loss, rel=apart)
    assert upright.lower[0] == 0
    assert inverting.lower[0] == pytest.approx(-inverting.upper[0])


@pytest.mark.parametrize("word", [word for word in blocks.words() if blocks.folder(word) == "hysteresis"])
def test_every_operator_may_be_turned_round(word):
    """By a parameter of its output that is searched within bounds of either sign, or else is solved for."""
    _, records = made(["bouc_wen"], TRUTH, noise=2e-8)
    records = [dataclasses.replace(record, response=-record.response) for record in records]
    problem = Problem(Chain([blocks[word]], ["x"], [0]), records)
    declared = [problem.model.entries[column].parameter for column in problem.free]
    turns = [item.unit in ("response", "response/drive") and item.bounds[0] >= 0 for item in declared]
    assert any(turns)
    assert (problem.lower[turns] < 0).all() and np.allclose(problem.lower[turns], -problem.upper[turns])


def test_a_constant_drive_is_no_scale():
    drive, response = np.ones((1, 50)), np.arange(50.0)[None]
    records = [Record("r", "identify", 1e-3, drive, response, file="rest.csv")]
    model = Chain([blocks["bouc_wen"]], ["x"], [0])
    with pytest.raises(InputError, match=r"rest.csv: the drive of axis x is constant"):
        Problem(model, records)
    assert Problem(model, records, {name: spec((0.1, 1)) for name in TRUTH}).names == tuple(TRUTH)


def test_standard_errors_cover_the_truth():
    model, records = made(["bouc_wen"], TRUTH, noise=2e-8)
    problem = Problem(model, records)
    point, _ = polish(problem, problem.unit_point(TRUTH))
    found, correlation = estimates(problem, point)
    assert [item.verdict for item in found] == ["determined"] * 4
    for item in found:
        assert abs(item.value - TRUTH[item.name]) < 5 * item.standard_error
        assert item.standard_error < 0.05 * abs(item.value)
    np.testing.assert_allclose(np.diag(correlation), 1)


def test_slow_data_do_not_determine_the_mechanics():
    model, records = made(["bouc_wen", "lumped"], TRUTH | MECHANICS, noise=2e-8)
    specs = {
        "lumped.mass": spec((0.15, 0.17)),
        "lumped.damping": spec((50, 150)),
        "lumped.stiffness": spec((6e7, 8e7)),
    }
    problem = Problem(model, records, specs)
    found, _ = estimates(problem, problem.unit_point(TRUTH | MECHANICS))
    verdicts = {item.name: item.verdict for item in found}
    assert {verdicts[name] for name in MECHANICS} == {"not determined"}
    assert {verdicts[name] for name in TRUTH} == {"determined"}


def test_a_parameter_on_its_bound_is_named():
    model, records = made(["bouc_wen"], TRUTH)
    problem = Problem(model, records, {"bouc_wen.gain": spec((0.0, 0.08))})
    point, _ = polish(problem, problem.unit_point(TRUTH))
    found, _ = estimates(problem, point)
    assert found[0].verdict == "on its upper bound"


def test_a_record_shorter_than_the_model_needs():
    short = Record("r", "identify", 1e-3, np.arange(5.0)[None], np.arange(5.0)[None], file="short.csv")
    with pytest.raises(InputError, match=r"short.csv: 4 scored samples for 4 free parameters.*\n.*longer"):
        Problem(Chain([blocks["bouc_wen"]], ["x"], [0]), [Record(**{**short.__dict__, "settle": 1})])


@pytest.mark.parametrize(
    ("field", "says"), [(2400.0, "at least 2400 V .* linear"), (0.01, "at most 0.01 V .* at once")]
)
def test_a_field_far_from_the_drive_is_refused(field, says):
    """Volts where volts per metre are meant, or a drive that never leaves the linear range."""
    drive = 80 * (1 - np.cos(np.arange(500) / 30))
    record = Record("r", "identify", 1e-3, drive[None], drive[None] * 1e-7, response_units=("um",))
    model = Chain([blocks["homogenized_energy"]], ["x"], [0])
    with pytest.raises(InputError, match=says) as error:
        Problem(model, [record], {"homogenized_energy.coercive": spec(value=field)})
    assert error.value.where == "homogenized_energy.coercive" and "50 V/m" in error.value.remedy
    Problem(model, [record], {"homogenized_energy.coercive": spec(bounds=(1, 2400))})


@pytest.mark.parametrize(
    ("unit", "said", "size"), [("V", "um/V", 1), ("kV/mm", "um/(kV/mm)", 1e6), ("V/m", "um/(V/m)", 1)]
)
def test_a_response_per_field_has_the_field_in_brackets(unit, said, size):
    """And the same bounds in SI units whatever the field is given in."""
    drive = size * np.abs(np.sin(np.arange(500) / 30))
    record = Record(
        "r", "identify", 1e-3, drive[None], drive[None] * 1e-6 / size, drive_units=(unit,), response_units=("um",)
    )
    problem = Problem(Chain([blocks["homogenized_energy"]], ["x"], [0]), [record])
    assert problem.units[0] == said
    assert problem.all_units[5] == f"um/({unit})^2".replace("(V)", "V")
    assert problem.upper[0] == pytest.approx(3.0, rel=1e-3)


def test_a_number_of_two_kinds_cannot_be_shared():
    drive = np.vstack([np.sin(np.arange(200) / 30)] * 2)
    record = Record("r", "identify", 1e-3, drive, drive * 1e-6, **TWO)
    model = Chain(
        [blocks["homogenized_energy"].make(density="free")], TWO["axes"], [0, 1], ["homogenized_energy.weight_3"]
    )
    with pytest.raises(
        InputError, match=r"weight_3 is in um and in uC/cm2: no single number fits both.*\n.*density: shared"
    ):
        Problem(model, [record])


@pytest.mark.parametrize(
    ("block", "word", "bounds", "says"),
    [
        ("homogenized_energy", "spread", (-1, 2), "a standard deviation of -1 is below zero"),
        ("thermal_homogenized_energy", "spread", (-0.5, 2), "a standard deviation of -0.5 is below zero"),
        ("domain_wall", "reversible", (0.5, 1.5), "a share from 0.5 to 1.5"),
    ],
)
def test_a_density_or_share_that_cannot_be_is_refused(block, word, bounds, says):
    drive = np.sin(np.arange(200) / 30)
    record = Record("r", "identify", 1e-3, drive[None], drive[None])
    with pytest.raises(InputError, match=says) as error:
        Problem(Chain([blocks[block]], ["x"], [0]), [record], {f"{block}.{word}": spec(bounds=bounds)})
    assert error.value.where == f"{block}.{word}"


def test_no_mechanics_moves_a_charge():
    drive = np.vstack([np.sin(np.arange(200) / 30)] * 2)
    record = Record("r", "identify", 1e-3, drive, drive * 1e-6, **TWO)
    model = Chain([blocks["bouc_wen"], blocks["lumped"]], TWO["axes"], [0, 1])
    with pytest.raises(InputError, match="'lumped' moves a displacement, but the response of axis y is in uC/cm2"):
        Problem(model, [record])


def test_records_are_pooled_by_their_scored_samples_each_about_its_own_mean():
    """Gains that are 1e-7 and 2e-3 too high on two axes: the errors are those of the drives, by hand."""
    straight = {f"{axis}.bouc_wen.{word}": spec(value=0.0) for axis in "xy" for word in ("alpha", "gamma")}
    straight |= {f"{axis}.bouc_wen.beta": spec(value=0.01) for axis in "xy"}
    straight |= {"x.bouc_wen.gain": spec(value=0.3), "y.bouc_wen.gain": spec(value=0.5)}  # um/V, uC/cm2/V: 5e-3 C/m2/V
    model, rng, records = Chain([blocks["bouc_wen"]], "xy", (0, 1)), np.random.default_rng(6), []
    for name, use, samples, settle in (("a", "identify", 300, 0), ("b", "identify", 100, 40), ("c", "validate", 80, 9)):
        drive = rng.uniform(0, 10, (2, samples)) * (3 if name == "b" else 1)
        response = np.array([[2e-7], [3e-3]]) * drive + rng.normal(size=(2, 1))
        records.append(Record(name, use, 1e-3, drive, response, settle=settle, **TWO))
    sizes, point = np.array([1e-8, 1e-2]), np.zeros((1, 0))
    problem = Problem(model, records, straight, sizes)
    for use in ("identify", "validate"):
        own = [record.drive[:, record.settle :] for record in records if record.use == use]
        squares = sum(np.square(drive - drive.mean(axis=1, keepdims=True)).sum(axis=1) for drive in own)
        rmse = np.array([1e-7, 2e-3]) * np.sqrt(squares / sum(drive.shape[1] for drive in own))
        np.testing.assert_allclose(problem.by_axis(point, use)[0], rmse, rtol=1e-6)
        assert problem.loss(point, use)[0] == pytest.approx(np.sqrt(np.mean((rmse / sizes) ** 2)), rel=1e-6)
    assert problem.scored == 2 * (300 + 60)
    assert np.linalg.norm(problem.residuals(point)) == pytest.approx(problem.loss(point)[0], rel=1e-6)
