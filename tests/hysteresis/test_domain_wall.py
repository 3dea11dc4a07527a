"""The domain wall model against its differential equation and the numbers of Smith and Salapaka."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import smith
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.caveats import broken_conditions
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.engine.simulator import Simulator
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.model.chain import Chain
from pzt_ident.report.page import write_report
from pzt_ident.run.identify import run
from pzt_ident.run.place import Local
from pzt_ident.run.statement import read
from pzt_ident.search.problem import Problem
from rig import block_of, path, record, response
from twins import domain_wall_twin as twin


def displacement(field, word="domain_wall", **known):
    return response([block_of(word)], smith.domain_wall(**known), np.asarray(field, float))


def biased(field, **known):
    return displacement(field, "domain_wall:biased", **known)


@pytest.mark.parametrize("known", [smith.DW1, smith.DW2, {"alpha": 0.0, "k": 1e4, "c": 0.0}])
def test_solves_its_differential_equation(known):
    field = path(-1000, 13500, -1000, 8000, 2000, points=10)
    expected = smith.STRAIN * twin.domain_wall(field, a=4.6e5, p_s=0.49, **known)
    np.testing.assert_allclose(displacement(field, **known), expected, rtol=0, atol=5e-3 * np.ptp(expected))
    fine = displacement(path(-1000, 13500, -1000, 8000, 2000, points=400), **known)[::40]
    np.testing.assert_allclose(fine, expected, rtol=0, atol=1e-5 * np.ptp(expected))


@pytest.mark.parametrize("word", ["domain_wall", "domain_wall:biased"])
@pytest.mark.parametrize("first", [-9000.0, 4000.0, 12000.0])
def test_a_record_that_begins_at_a_field_went_there_from_an_unpolarized_state(word, first):
    begun = displacement([first, 0.5 * first], word, **smith.DW1)
    way = displacement(path(0, first, points=800), word, **smith.DW1)
    assert begun[0] == pytest.approx(way[-1], rel=1e-6)


@pytest.mark.parametrize("known", [smith.DW1, smith.DW2])
def test_loop_of_figure_4(known):
    """Span 11.5 um and width 12 % between -1 and 13.5 kV/m; closed from the third cycle on."""
    points = 400
    found = displacement(path(0, *[13500, -1000] * 4, points=points), **known)
    rising, falling = found[-2 * points - 1 : -points], found[-points - 1 :]
    assert np.ptp(rising) == pytest.approx(11.5e-6, rel=0.01)
    assert 100 * np.max(falling[::-1] - rising) / np.ptp(rising) == pytest.approx(12.0, abs=0.3)
    ends = found[2 * points :: 2 * points]
    assert abs(ends[-1] - ends[-2]) < 1e-2 * np.ptp(rising)
    slope = (falling[0] - falling[points // 100]) / (np.ptp(rising) / 100)
    assert 0.8 < slope < 0.9


def test_after_a_reversal_walls_only_bend():
    """The irreversible part waits until the anhysteretic curve is behind it: no negative slope."""
    found = displacement(path(0, 13500, 13000, points=200), **smith.DW1)
    assert np.all(np.diff(found[:201]) > 0) and np.all(np.diff(found[201:]) < 0)


def test_single_solution_is_the_anhysteretic_curve_without_pinning():
    field = path(0, 13500, -1000, points=50)
    found = displacement(field, alpha=4.5e5, k=1.47e4, c=1.0)
    expected = [twin.anhysteretic(0.0, e, 4.6e5, 4.5e5, 1.0, 0.49) for e in field]
    np.testing.assert_allclose(found, smith.STRAIN * np.array(expected), rtol=0, atol=1e-15)


@pytest.mark.parametrize("word", ["domain_wall", "domain_wall:biased"])
def test_mirrored(word):
    field = path(0, 13500, -4000, 2000, points=60)
    found = displacement(field, word, **smith.DW1)
    np.testing.assert_allclose(displacement(-field, word, **smith.DW1), -found, rtol=1e-12)


@pytest.mark.parametrize("known", [smith.DW1, smith.DW2, {"alpha": 0.0, "k": 1e4, "c": 0.0}])
def test_biased_minor_loops_solve_their_equations(known):
    """Eq. 5 between reversals, P continuous at them."""
    rise, fall, back = np.linspace(0, 8000, 11)[1:], np.linspace(8000, 2000, 11)[1:], np.linspace(2000, 7000, 11)[1:]
    expected = smith.STRAIN * twin.minor_loop(rise, fall, back, a=4.6e5, p_s=0.49, **known)
    field = np.concatenate([path(0, 8000, 2000, points=1000), np.linspace(2000, 7000, 1001)[1:]])
    np.testing.assert_allclose(biased(field, **known)[100::100], expected, rtol=0, atol=1e-6 * np.ptp(expected))


def test_a_rescaled_curve_goes_through_the_reversal_and_its_reflection():
    """Eq. 5 for any reversal and bias; without pinning P is that curve."""
    given = {"a": 4.6e5, "alpha": 4.5e5, "p_s": 0.49}
    for top in ((8000.0, 0.004), (3e5, 0.2), (-2e4, -0.3)):
        assert twin.biased(top, (0.0, 0.0), -1, **given)(*top) == pytest.approx(top[1], abs=1e-15)
        assert twin.biased(top, top, 1, **given)(*top) == pytest.approx(top[1], abs=1e-15)
        e0, p0 = 0.3 * top[0], 0.2 * top[1]
        there = 2 * e0 - top[0], 2 * p0 - top[1]
        assert twin.biased(top, (e0, p0), 1, **given)(*there) == pytest.approx(there[1], abs=1e-15)
    field = path(0, 4e5, -2e5, points=50)
    found = biased(field, alpha=4.5e5, k=1.47e4, c=1.0) / smith.STRAIN
    curve = twin.biased((4e5, found[50]), (0.0, 0.0), -1, **given)
    np.testing.assert_allclose(found[50:], curve(field[50:], found[50:]), rtol=0, atol=1e-14)


@pytest.mark.parametrize("known", [smith.DW1, smith.DW2])
def test_biased_minor_loops_close_and_are_forgotten(known):
    """To rounding, whichever way the first leg went; the open ones of the same walls do not."""
    legs, points = [0, 8000, 3000, 8000, 3000, 12000], 100
    for sign in (1, -1):
        found = biased(sign * path(*legs, points=points), **known)
        ends = found[points::points]
        assert ends[2] == pytest.approx(ends[0], rel=1e-12) and ends[3] == pytest.approx(ends[1], rel=1e-12)
        outer = biased(sign * path(0, 8000, 12000, points=points), **known)
        assert ends[-1] == pytest.approx(outer[-1], rel=1e-4)
    open_ends = displacement(path(*legs, points=points), **known)[points::points]
    assert abs(open_ends[2] - open_ends[0]) > 0.02 * open_ends[0]


@pytest.mark.parametrize("word", ["domain_wall", "domain_wall:biased"])
def test_walls_that_break_condition_9_are_said_to(word):
    """alpha P_s > a has walls run away that start to move, those of DW1 never do."""
    model, field = Chain([block_of(word)], "x", [0]), record(path(0, 13500, -1000, 4000, points=100))

    def violations(**known):
        values = smith.domain_wall(**known)
        return Simulator(model, field).violations(np.array([[values[name] for name in model.names]]))

    assert violations(**smith.DW1) == ()
    (said,) = violations(alpha=4.5e6, k=2e3, c=0.1)
    assert "condition (9)" in said and "% of its samples" in said and "`domain_wall.pinning`" in said


JOB = """\
name: walls
records: [{file: loop.csv, use: identify}]
channels:
  time: "time [s]"
  axes:
    x: {drive: "E [V/m]", response: "x [um]"}
model: [{name: domain_wall, minor_loops: biased}]
parameters:
  domain_wall.coupling: {value: 4.79}
  domain_wall.reversible: {value: 0.1}
  domain_wall.pinning: {value: 2000}
  domain_wall.width: {value: 4.6e+5}
optimizers: [{name: least_squares, budget: 20}]
polish: false
"""


def test_a_job_says_that_its_walls_run_away(tmp_path):
    """In its result, its report and its diagnosis."""
    field = path(0, 13500, -1000, 4000, points=60)
    rows = np.column_stack([np.arange(field.size) / 1e3, field, 1e6 * displacement(field, **smith.DW1)])
    np.savetxt(tmp_path / "loop.csv", rows, "%.9g", ",", header="time [s],E [V/m],x [um]", comments="")
    job = Job.from_text(JOB, tmp_path)
    folder = run(job, tmp_path / "out", place=Local(1))
    (note,) = json.loads((folder / "result.json").read_text())["records"][0]["notes"]
    assert "condition (9)" in note
    assert "Record loop: at" in write_report(folder).read_text()
    case = Case(job.model, (), read(job), job.parameters)
    assert "Record loop: at" in broken_conditions(first_fit(case, 0))


def test_another_form_is_unknown():
    with pytest.raises(InputError, match=r"minor_loops: 'bised' is no such form") as error:
        Job.from_text(JOB.replace("minor_loops: biased", "minor_loops: bised"))
    assert "did you mean 'biased'?" in str(error.value)


def test_a_set_that_can_only_run_away_is_refused():
    """As printed: c alpha P_s / a = 3.9."""
    model, field = Chain([block_of("domain_wall")], "x", [0]), record(path(0, 13500, points=100))
    values = {
        name: SimpleNamespace(bounds=None, value=value) for name, value in smith.domain_wall(**smith.PRINTED).items()
    }
    with pytest.raises(InputError, match=r"c alpha P_s / a is 3.88 or more: no polarization is stable") as error:
        Problem(model, [field], values)
    assert error.value.where == "domain_wall.coupling" and "smaller alpha" in error.value.remedy


def test_set_as_printed_runs_away():
    assert np.isnan(displacement(path(0, 13500, points=50), **smith.PRINTED)).all()


def test_walls_that_run_away_end_on_the_anhysteretic_curve():
    """Against condition (9), k - alpha (P_an - P_irr) > 0."""
    field = path(0, 2e5, points=50)
    found = displacement(field, alpha=4.5e5, k=1e3, c=0.2)
    expected = [twin.anhysteretic(0.0, e, 4.6e5, 4.5e5, 1.0, 0.49) for e in field]
    np.testing.assert_allclose(found[5:], smith.STRAIN * np.array(expected)[5:], rtol=1e-2)
