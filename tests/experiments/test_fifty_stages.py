"""The simulator of the fifty stages against closed forms, a case from its name to its job, and scores by hand."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp

from experiments.fifty_stages import draw, jobs, operators, score, stage, stages, tally
from experiments.fifty_stages.mechanics import NO_FRICTION, Friction, Table, linear, motion
from pzt_ident.cli.commands import main

BOUC_WEN = {"base": "bouc_wen", "gain": 0.1, "alpha": 0.4, "beta": 0.05, "gamma": 0.02}
PLAYS = {"base": "prandtl_ishlinskii", "gain": 0.05, "reach": 50.0} | {f"weight_{i}": 0.005 for i in range(1, 9)}
MASS = {"mass": 0.2, "stiffness": 0.2 * (2 * np.pi * 200) ** 2, "damping": 10.0}
RIGID = Table(0.2, 10.0, 0.2 * (2 * np.pi * 200) ** 2, 0.0, 0.0, 0.0, 0.0, 1e9, 0.0, 0.0, 0.0)
ALL = {
    f"{name} {effect['effect']}": (name, effect) for name in stages.STAGES for effect in stages.STAGES[name]["effects"]
}


def triangle(*turns, each=400):
    return np.concatenate([np.linspace(a, b, each, endpoint=False) for a, b in itertools.pairwise(turns)])


def bouc_wen(u, dt=1e-3, branch=0.0, skew=0.0, rate=0.0, speed=1.0, relaxation=0.0, scale=0.0):
    return operators.bouc_wen(u, dt, 0.1, 0.4, 0.05, 0.02, branch, skew, rate, speed, relaxation, scale)


def records(top=100.0):
    loop = triangle(0, top, 0.2 * top, 0.7 * top, 0)
    record = {"start": 0.0, "way": 0.0, "phases": np.arange(4.0), "slips": (np.r_[0, 0.1, 0.2], np.r_[0, 0, 1])}
    return [record | {"u": np.array([loop, 0.5 * loop])}]


def axes(base, mechanics):
    return [base | mechanics, base | mechanics]


def test_bouc_wen_solves_its_equation_and_saturates_where_it_says():
    t = np.linspace(0, 6, 6001)

    def rates(t, h):
        slope = 80 * np.cos(2 * t)
        return 0.4 * slope - 0.05 * abs(slope) * h - 0.02 * slope * abs(h)

    h = solve_ivp(rates, (0, 6), [0.0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.01).y[0]
    u = 40 * np.sin(2 * t)
    assert np.max(np.abs(0.1 * (u - h) - bouc_wen(u))) < 2e-6
    wide = triangle(0, 1000, -1000, 0, each=4000)
    for branch in (0.0, 0.3):
        h = wide - bouc_wen(wide, branch=branch) / 0.1
        assert h.max() == pytest.approx(0.4 / (0.05 * (1 + branch) + 0.02), rel=1e-6)
        assert h.min() == pytest.approx(-0.4 / (0.05 * (1 - branch) + 0.02), rel=1e-6)


def test_a_rest_lets_the_state_relax_by_its_law():
    u = np.r_[np.linspace(0, 50, 1000), np.full(4000, 50.0)]
    h = u - bouc_wen(u, relaxation=0.5) / 0.1
    assert h[-1] == pytest.approx(h[999] * np.exp(-0.5 * 4.0), rel=1e-9)
    h = u - bouc_wen(u, relaxation=0.5, scale=2.0) / 0.1
    assert np.tanh(h[-1] / 4) == pytest.approx(np.tanh(h[999] / 4) * np.exp(-0.5 * 4.0), rel=1e-9)


def test_plays_follow_behind_their_half_widths_which_grow_with_the_rate():
    u = triangle(0, 50, 10, each=100)
    step, one = 0.5, (np.array([0.02]), np.array([5.0]))
    slow = operators.plays(u, 1.0, 0.05, *one, 0.0, 1.0)
    assert slow[99] == pytest.approx(0.05 * u[99] + 0.02 * (u[99] - 5))
    assert slow[-1] == pytest.approx(0.05 * u[-1] + 0.02 * (u[-1] + 5))
    fast = operators.plays(u, 1e-3, 0.05, *one, 0.1, 50.0)
    wider = 5 * (1 + 0.1 * np.log(1 + step / 1e-3 / 50))
    assert fast[99] == pytest.approx(0.05 * u[99] + 0.02 * (u[99] - wider))


def test_creep_of_a_step_is_a_sum_of_exponentials():
    f = np.r_[0.0, np.full(3000, 2.0)]
    shares, times, dt = np.array([0.1, 0.2]), np.array([0.05, 0.8]), 1e-3
    t = np.arange(3000) * dt
    crept = (operators.creep(f, dt, shares, times) - f)[1:]
    expected = 2 * sum(c * (1 - np.exp(-(t + dt / 2) / tau)) for c, tau in zip(shares, times, strict=True))
    assert np.max(np.abs(crept - expected)) < 1e-4


def test_the_table_is_its_transfer_function_and_the_spring_shares_the_force():
    f = np.r_[0.0, np.full(4000, 1.0)]
    k, still = RIGID.stiffness, np.zeros(4001)
    x, y = motion(f, still, 1e-5, RIGID, RIGID, False, 0.0, 0.0, NO_FRICTION)
    reference = linear(f, 1e-5, [1.0], [0.2 / k, 10.0 / k, 1.0])
    assert np.max(np.abs(x - reference)) < 1e-6 and not y.any()
    heavy = RIGID._replace(damping=500.0)
    long = np.r_[0.0, np.full(40000, 1.0)]
    x, y = motion(long, 0 * long, 1e-5, heavy, heavy, True, 0.1 * k, 0.0, NO_FRICTION)
    assert (x[-1], y[-1]) == pytest.approx((1.1 / 1.2, 0.1 / 1.2), abs=1e-6)


@pytest.mark.parametrize(("kind", "bristle"), [(1.0, 2.0), (2.0, 2.0), (3.0, 0.1)])
def test_friction_holds_its_level_back_where_the_table_slides(kind, bristle):
    ramp = np.linspace(0, 50, 20001)
    heavy = RIGID._replace(damping=200.0)
    friction = Friction(kind, bristle, 0.3, 0.3, 30.0, 0.0)
    free, _ = motion(ramp, 0 * ramp, 2e-5, heavy, heavy, False, 0.0, 0.0, NO_FRICTION)
    held, _ = motion(ramp, 0 * ramp, 2e-5, heavy, heavy, False, 0.0, 0.0, friction)
    assert free[-1] - held[-1] == pytest.approx(0.3, abs=1e-6)


def test_a_slew_limit_runs_after_the_command():
    u = np.r_[0.0, np.full(200, 5.0)]
    assert np.allclose(stage.slew_limited(u, 1e-3, 100.0), np.minimum(np.arange(201) * 0.1, 5.0))


def test_a_stage_without_effects_is_its_base():
    (record,) = records()
    seen = stage.simulate([record], 1000.0, 1, [BOUC_WEN], {})[0][0]
    assert np.allclose(seen, bouc_wen(record["u"][0]), rtol=0, atol=1e-12)
    (seen,) = stage.simulate([record], 1000.0, 4, axes(PLAYS, {}), {})
    weights, widths = np.full(8, 0.005), np.arange(1, 9) * 6.25
    assert np.allclose(seen[1], operators.plays(record["u"][1], 1e-3, 0.05, weights, widths, 0.0, 1.0), atol=1e-12)


@pytest.mark.parametrize("which", ALL)
def test_effects_are_absent_at_size_zero_and_vanish_towards_it(which):
    name, effect = ALL[which]
    base = PLAYS if stages.STAGES[name]["base"] == "prandtl_ishlinskii" else BOUC_WEN
    both = axes(base, MASS if "resonance" in stages.STAGES[name] else {})
    without, acts = stage.simulate(records(), 2000.0, 5, both, {})[0], dict(effect["acts"])
    rest = {"quadratic": 0.0} if "quadratic" in acts else {"back": 0.0} if "back" in acts else {}

    def changed(factor):
        acting = {effect["effect"]: acts | rest | {"size": factor * acts["size"]}}
        return np.max(np.abs(stage.simulate(records(), 2000.0, 5, both, acting)[0] - without))

    whole = 60.0 if effect["effect"] == "slew_limit" else 1.0  # the loop is slow
    assert changed(0.0) == 0
    assert changed(whole) > 1e-5
    assert changed(0.1 * whole) < 0.2 * changed(whole)


def test_there_are_fifty_stages():
    kinds = [given["kind"] for given in stages.STAGES.values()]
    assert [kinds.count(kind) for kind in tally.KINDS] == [24, 12, 8, 6]


def test_the_size_of_an_effect_is_what_its_base_cannot_take_up():
    case, _ = draw.draw("s18_sven")
    directions = draw._directions(case, [])
    trace = draw._trace(case, 0, directions)
    assert np.sqrt(np.mean(trace**2)) / case["sigma"] == pytest.approx(case["sizes"][0], abs=0.01)
    assert np.max(np.abs(directions.T @ trace)) < 1e-9


def test_a_case_is_the_same_twice_and_its_job_is_accepted(tmp_path):
    for folder in ("first", "second"):
        jobs.write("s12_lena", tmp_path / folder)
    first, second = (tmp_path / folder / "s12_lena" for folder in ("first", "second"))
    files = sorted(path.relative_to(first) for path in first.rglob("*.*"))
    assert len(files) == 8 and all((first / file).read_bytes() == (second / file).read_bytes() for file in files)
    truth = json.loads((first / "truth.json").read_text())
    assert truth["truth"] == ["delay"] and 5 < truth["floors"][0] < 62
    said = CliRunner().invoke(main, ["check", str(first / "rig" / "job.yaml")])
    assert said.exit_code == 0, said.output


def answer(effects, group=(), validate=0.002):
    steps = [{"added": None, "class": [], "rmse": {"validate": 0.1}}]
    steps += [{"added": e, "class": [e, *group], "rmse": {"validate": validate}} for e in effects]
    improvement = {"effects": list(effects), "steps": steps, "suspects": [], "unit": "um", "verdict": "adequate"}
    return {"exit": 0, "cpu": 10.0, "improvement": improvement}


def hidden(*effects, kind="single", **also_right):
    outside = list(effects) if kind == "outside" else []
    truth = {"name": "s01_anna", "kind": kind, "truth": [] if outside else list(effects), "outside": outside}
    truth |= {"words": ["w"] * len(effects), "floors": [9.0] * len(effects), "also_right": also_right}
    return truth | {"base": "bouc_wen", "sigma_nm": 2.0}


def test_scores():
    exact = score.score(hidden("delay"), answer(["delay"]))
    assert exact["exact"] and exact["in_class"] and not exact["extra"] and exact["floors_left"] == 1.0
    tie = score.score(hidden("sensor_lag"), answer(["delay"], ["sensor_lag"]))
    assert not tie["exact"] and tie["in_class"] and not tie["extra"]
    also = score.score(hidden("sensor_lag", sensor_lag=["delay"]), answer(["delay"]))
    assert not also["exact"] and also["in_class"] and not also["extra"]
    more = score.score(hidden("creep"), answer(["creep", "drift"]))
    assert not more["exact"] and more["in_class"] and more["extra"] == ["drift"]
    half = score.score(hidden("creep", "friction", kind="pair"), answer(["creep"]))
    assert not half["in_class"] and half["missed"] == ["friction"]
    none = score.score(hidden("ageing", kind="outside"), answer([]))
    assert none["exact"] and none["in_class"]
    late = score.score(hidden("creep"), {"exit": "time", "cpu": 900.0, "improvement": None})
    assert late["verdict"] == "out of time" and late["missed"] == ["creep"]
    text = tally.markdown([exact, tie, more, half, none, late])
    assert "| single | 4 | 1/4 | 3/4 | 1 |" in text and "wrong: drift" in text


def test_reference_rows_are_those_of_its_table():
    folder = Path(stage.__file__).parents[2] / "results" / "reference" / "fifty_stages"
    rows = json.loads((folder / "rows.json").read_text())
    assert [row["name"] for row in rows] == list(stages.STAGES)
    assert tally.markdown(rows) == (folder / "table.md").read_text()
