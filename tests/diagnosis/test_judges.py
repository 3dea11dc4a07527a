"""A record that shows what the identification records leave open judges no model."""

from dataclasses import replace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.caveats import caveats
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.judges import as_good, judged, left_open
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import blocks
from pzt_ident.run.findings import by_record

MODEL = ("bouc_wen", "lumped")
MODE = {"lumped.mass": 1.5, "lumped.damping": 70.0}  # 1.1 kHz
TIME = 1e-4 * np.arange(2000)
SLOW = [50 * np.sin(np.pi * f * TIME) ** 2 for f in (10, 15)]
JUMPS = 10 * np.cumsum(np.isin(np.arange(TIME.size), (300, 700, 1300)))


def made(drives, uses, missing=None):
    parameters = MODE | (missing or {})
    pairs = [stage.records(parameters, [drive, drive], dt=1e-4, model=MODEL)[0] for drive in drives]
    records = [replace(record, use=use, name=name) for record, (use, name) in zip(pairs, uses, strict=True)]
    return Case(MODEL, (), records, stage.specs({"lumped.stiffness": 7e7, "lumped.damping": 70.0}))


def beside(case, mass, effects=()):
    """The fit of the stage itself, but for a mass that slow drives do not determine."""
    problem = case.problem(effects)
    values = {name: (stage.STAGE | MODE).get(name, 0.0) for name in problem.names}
    return fit_at((), problem, problem.unit_point(values | {"bouc_wen.gain": 0.082, "lumped.mass": mass}))


ALL = [*SLOW, JUMPS]
USES = [("identify", "slow"), ("validate", "unseen"), ("validate", "jumps")]


def test_what_slow_drives_leave_open_of_a_mode_its_ringing_does_not_judge():
    case = made(ALL, USES)
    fit = beside(case, 0.5)
    assert fit.validate > 10 * case.floor
    other, again = judged(case, fit)
    assert [record.name for record in other.records if not record.judges] == ["jumps"]
    assert again.validate == pytest.approx(stage.NOISE, rel=0.1)
    assert again.identify == pytest.approx(fit.identify)
    assert "Nothing is judged by jumps" in caveats(other, again) and caveats(other, again) == caveats(case, again)
    assert by_record(other, again) == by_record(case, fit)


def test_where_an_effect_leads_to_the_noise_on_all_records_all_can_judge():
    case = made(ALL, USES)
    fit, account = beside(case, 0.5), beside(case, 1.5)
    assert judged(case, fit, [account]) == (case, fit) != judged(case, fit, [fit])


def test_points_that_fit_as_well_do():
    case = made(ALL, USES)
    fit = beside(case, 1.5)
    points = as_good(fit)
    assert len(points) > 10
    assert fit.problem.loss(points).max() <= 1.1 * fit.identify
    assert np.ptp(points[:, fit.problem.names.index("lumped.mass")]) > 0.2


def test_any_mechanics_fit_as_well_that_no_record_shows():
    """A mode far above all drives may be anywhere, also from where it has no damping."""
    made_slow = made(SLOW, USES[:2])
    case = Case(MODEL, (), made_slow.records, {})
    problem = case.problem(())
    values = stage.STAGE | {"bouc_wen.gain": 0.08, "lumped.mass": 1, "lumped.stiffness": 1e7, "lumped.damping": 0}
    fit = fit_at((), problem, problem.unit_point(values))
    points = as_good(fit)
    assert fit.problem.loss(points).max() <= 1.1 * fit.identify
    for name in ("lumped.mass", "lumped.damping"):
        assert np.ptp(points[:, fit.problem.names.index(name)]) > 0.5


@pytest.mark.parametrize(
    ("drives", "uses", "mass"),
    [
        (ALL, USES, 1.5),
        ([*ALL, JUMPS[::-1].copy()], [*USES, ("identify", "other jumps")], 0.5),
    ],
    ids=["a model that is right", "a mode that is determined"],
)
def test_all_records_kept_back_judge(drives, uses, mass):
    case = made(drives, uses)
    fit = beside(case, mass)
    assert judged(case, fit) == (case, fit)
    assert not case.caveat


def test_where_no_record_kept_back_can_judge_the_identification_records_do():
    case = made([SLOW[0], JUMPS], [USES[0], USES[2]])
    fit = beside(case, 0.5)
    other, again = judged(case, fit)
    assert fit.validate > 10 * case.floor and again.validate is None
    assert "Nothing is judged by jumps" in caveats(other, again)
    assert by_record(other, again) == by_record(case, fit)


def test_what_a_record_kept_back_shows_of_an_effect_is_held_against_the_model():
    """The same error at any mass: it is no matter of what the others leave open."""
    case = made(SLOW, USES[:2])
    bent = [
        record if record.use == "identify" else replace(record, response=1.2 * record.response)
        for record in case.records
    ]
    case = Case(MODEL, (), [*bent, replace(case.records[1], name="third")], case.specs)
    assert left_open(case, beside(case, 0.5)) == []


def test_an_effect_is_named_beside_a_mode_that_only_a_record_kept_back_shows():
    case = made(ALL, USES, missing={"quadratic_gain.curvature": 3e-3})
    case.ruled_out = tuple({*blocks.effects()} - {"quadratic_gain", "creep"})
    first = first_fit(case, 0)
    assert first.validate > 10 * case.floor
    found = improve(case, first)
    assert found.steps[-1].fit.effects == ("quadratic_gain",)
    assert found.steps[-1].fit.validate < 2 * case.floor
    assert found.case is not case
