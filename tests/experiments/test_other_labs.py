"""The stages of other labs against closed forms and laws, and their campaigns against the package's words and jobs."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from experiments.other_labs import dynamics, hysteresis, score, tally, writing
from experiments.other_labs.campaign import CAMPAIGNS
from experiments.other_labs.drives import Drive
from experiments.other_labs.names import NAMES
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks

FOLDER = Path(hysteresis.__file__).parent
OSCILLATOR = {"mass": 0.5, "damping": 12.0, "stiffness": 2.0e5}


def test_drive_builder_keeps_lengths_and_ends():
    drive = Drive(1000).rest(0.2).ramp(50, 0.1).stairs([20, 80], 0.05).triangles(10, 30, 2).reversals([10, 60], 500)
    u = drive.array()
    assert len(u) == 1 + 200 + 100 + 2 * 50 + 2 * 100 + 140 + 100
    assert (u[200], u[300], u[350], u[400], u[-1]) == (0, 50, 20, 80, 60)
    assert u[450] == pytest.approx(30) and u[600] == pytest.approx(80)
    assert np.all(drive.array(1000)[len(u) :] == 60)


def test_segments_that_are_whole_turns_come_back():
    rng = np.random.default_rng(1)
    drive = Drive(2000, 5)
    for segment in (
        lambda: drive.loops(4, 90, 3),
        lambda: drive.sine(10, 20, 5),
        lambda: drive.chirp(5, 300, 0.5, 4),
        lambda: drive.multisine([3, 11, 40], 15, 0.5, rng),
        lambda: drive.noise(2, 100, 30, 0.5, rng),
    ):
        segment()
        assert drive.values[-1] == pytest.approx(5, abs=1e-9)
    u = drive.array()
    assert u[: 2000 * 3 // 4].max() == pytest.approx(95) and u[: 2000 * 3 // 4].min() >= 5 - 1e-9


def test_what_is_cycled_ahead_is_not_recorded():
    drive = Drive(1000).cycled(10, 100).rest(0.1)
    assert drive.ahead == 300 + 200 and max(drive.values[drive.ahead :]) < 1e-9


def test_random_voltage_stays_in_its_band_and_height():
    u = Drive(1000).noise(20, 60, 30, 4, np.random.default_rng(2)).array()
    power, frequency = np.abs(np.fft.rfft(u)) ** 2, np.fft.rfftfreq(len(u), 1e-3)
    assert np.abs(u).max() == pytest.approx(30)
    assert power[(frequency > 18) & (frequency < 62)].sum() > 0.98 * power.sum()


def test_play_is_the_nearest_value_within_its_width():
    u = Drive(100).reversals([50, -20, 35, 10], 100).array()
    out = hysteresis.plays(u, [8.0, 15.0])
    for column, width in enumerate((8.0, 15.0)):
        state = 0.0
        for i, value in enumerate(u):
            state = min(max(state, value - width), value + width)
            assert out[i, column] == state


def test_bouc_wen_saturates_and_follows_its_equation():
    u = Drive(1000).reversals([1000, -1000], 1000).array()
    h = 0.1 * u - hysteresis.bouc_wen(u, 0.1, 0.4, 0.05, 0.02)
    assert (h.max(), h.min()) == (pytest.approx(0.04 / 0.07), pytest.approx(-0.04 / 0.07))
    rising = np.arange(1001)
    assert h[:1001] == pytest.approx(0.04 / 0.07 * -np.expm1(-0.07 * u[rising]), abs=1e-12)


def test_generalised_bouc_wen_without_its_shape_is_bouc_wen():
    u = Drive(500).sine(1, 80, 2).array()
    own = hysteresis.generalised_bouc_wen(u, 0.1, 0.4, 0.02, 0.01, longest=2e-4)
    assert own == pytest.approx(hysteresis.bouc_wen(u, 0.1, 0.4, 0.02, 0.01), abs=1e-5)


def test_relaxation_at_rest_is_exponential():
    u = Drive(100).ramp(60, 0.5).rest(3).array()
    y = hysteresis.bouc_wen(u, 0.1, 0.4, 0.02, 0.01, relax=lambda h, dt: h * math.exp(-dt / 2), dt=0.01)
    h = 0.1 * u - y
    assert h[150] == pytest.approx(h[50] * math.exp(-0.5), rel=1e-9)


@pytest.mark.parametrize(
    "operator",
    [
        lambda u: hysteresis.prandtl_ishlinskii(u, 0.1, 40.0, [0.01] * 8),
        lambda u: hysteresis.free_energy(u, 0.05, 90.0, 30.0, 0.6, 70.0),
        lambda u: hysteresis.preisach(u, 0.1, 50.0, *hysteresis.two_groups(10, 35, 60)),
    ],
)
def test_a_larger_loop_wipes_out_what_was_within_it(operator):
    nested = operator(Drive(200).reversals([100, 30, 60, 30, 100, 0], 200).array())
    plain = operator(Drive(200).reversals([100, 0], 200).array())
    assert nested[-1] == pytest.approx(plain[-1], abs=1e-9)


def test_domain_walls_that_bend_only_follow_the_anhysteretic_curve():
    u = Drive(200).triangles(1, 300, 1).array()
    assert hysteresis.domain_walls(u, 20.0, 100.0, 0.0, 50.0, 1.0) == pytest.approx(20 * np.tanh(u / 100), abs=1e-9)
    pinned = hysteresis.domain_walls(u, 20.0, 100.0, 0.3, 50.0, 0.3)
    assert pinned[50] < pinned[150] < 20  # at half the peak, on the way up and down


def test_lag_answers_a_ramp_and_a_step_as_its_equation():
    t = np.arange(2000) * 1e-3
    assert dynamics.lag(t, 1e-3, 0.05) == pytest.approx(t - 0.05 * -np.expm1(-t / 0.05), abs=1e-12)
    step = np.append(0.0, np.ones(500))
    edge = 1 - 50 * -math.expm1(-0.02)
    expected = 1 - (1 - edge) * np.exp(-np.arange(500) * 1e-3 / 0.05)
    assert dynamics.lag(step, 1e-3, 0.05)[1:] == pytest.approx(expected, abs=1e-12)


def test_mode_decays_freely_at_its_own_frequency():
    dt, frequency, damping = 1e-4, 80.0, 0.03
    y = dynamics.mode(np.append(np.ones(1), np.zeros(4000)), dt, frequency, damping)[1:]
    period = 1 / (frequency * math.sqrt(1 - damping**2))
    late = np.interp(np.arange(1500) * dt + 3 * period, np.arange(4000) * dt, y)
    ratio = math.exp(-2 * math.pi * frequency * damping * 3 * period)
    assert late == pytest.approx(y[:1500] * ratio, abs=2e-4)


def test_integrated_oscillators_are_the_linear_one_where_nothing_bends_or_slips():
    force = Drive(20000).loops(40, 5, 2).rest(0.02).array()
    linear = dynamics.lumped(force, 5e-5, **OSCILLATOR)
    assert dynamics.oscillator(force, 5e-5, **OSCILLATOR, spring=lambda x: x) == pytest.approx(linear, abs=1e-5)
    free = dynamics.bristles(force, 5e-5, **OSCILLATOR, bristle=lambda z, v: v, friction=lambda z: 0.0)
    assert free == pytest.approx(linear, abs=1e-5)
    slipping = dynamics.maxwell_slip(force, 5e-5, **OSCILLATOR, stiffnesses=[0.2], limits=[0.0])
    assert slipping == pytest.approx(linear, abs=1e-9)


def test_slip_elements_hold_back_by_their_limits():
    force = Drive(5000).ramp(10, 1).rest(0.3).array()
    x = dynamics.maxwell_slip(force, 2e-4, **OSCILLATOR, stiffnesses=[0.5, 0.1], limits=[0.2, 0.3])
    behind = OSCILLATOR["damping"] / OSCILLATOR["stiffness"] * 10  # of a ramp of 10 um/s, by the damping
    assert x[5000] == pytest.approx(10 - 0.5 - behind, abs=1e-6)


def test_slew_limits_the_rate_and_only_that():
    u = Drive(1000).triangles(1, 1, 1).array()
    assert dynamics.slew(u, 1e-3, 3.0) == pytest.approx(u, abs=1e-15)
    assert np.abs(np.diff(dynamics.slew(u, 1e-3, 0.5))).max() == pytest.approx(0.5e-3)
    step = np.append(0.0, np.ones(4000))
    assert np.diff(dynamics.slow_lag(step, 1e-3, 0.2, 0.5)).max() == pytest.approx(0.5e-3)
    assert dynamics.slow_lag(step, 1e-3, 0.2, 1e9)[2001] == pytest.approx(-math.expm1(-2.001 / 0.2), abs=1e-9)


def test_creep_ends_at_the_sum_of_its_shares():
    y = dynamics.creep(np.append(0.0, np.full(5000, 2.0)), 0.01, [0.01, 0.03], [0.2, 3.0])
    assert y[-1] == pytest.approx(2 * 1.04, rel=1e-6)


def test_delay_shifts_and_holds_the_first_value():
    t = np.arange(100) * 0.1
    assert dynamics.late(t, t, 0.25) == pytest.approx(np.maximum(t - 0.25, 0))


def test_counts_are_multiples_and_nearest():
    x = np.random.default_rng(3).normal(size=500)
    y = writing.quantised(x, 0.05)
    assert np.abs(y / 0.05 - np.round(y / 0.05)).max() < 1e-9 and np.abs(y - x).max() <= 0.025 + 1e-12
    assert writing.quantised(x, 0.0) is x


def test_noise_has_its_size_and_memory():
    coloured = writing.noise(200_000, 0.02, 0.9, 0.5, np.random.default_rng(4))
    assert coloured.std() == pytest.approx(0.02, rel=0.02)
    assert np.corrcoef(coloured[1:], coloured[:-1])[0, 1] == pytest.approx(0.45, abs=0.02)
    white = writing.noise(200_000, 0.02, 0.0, 0.0, np.random.default_rng(4))
    assert white.std() == pytest.approx(0.02, rel=0.01)
    assert np.corrcoef(white[1:], white[:-1])[0, 1] == pytest.approx(0, abs=0.01)


def test_campaigns_are_declared_in_words_of_the_catalogue():
    words, kinds = set(blocks.effects()) - set(blocks.faults()), {"single": 1, "pair": 2, "none": 0, "outside": 0}
    assert NAMES == [f"n{number:02d}" for number in range(1, 49)] == sorted(writing.SIZES)
    for name in NAMES:
        declared = CAMPAIGNS[name]
        assert len(declared.effects) == kinds[declared.kind] and len(declared.what) > 20
        assert set(declared.effects) | {other for names in declared.also.values() for other in names} <= words
    assert {effect for declared in CAMPAIGNS.values() for effect in declared.effects} == words


@pytest.mark.parametrize("name", NAMES)
def test_campaigns_have_both_uses_and_their_noise(name):
    campaign = CAMPAIGNS[name].build()
    assert {record.use for record in campaign.records} == {"identify", "validate"}
    assert 0 < writing.noise_size(name, campaign) <= 0.05
    assert all(len({len(drive) for drive in record.drives.values()}) == 1 for record in campaign.records)


@pytest.mark.parametrize("name", ["n03", "n32", "n42"])
def test_jobs_are_accepted_and_show_nothing_of_the_truth(tmp_path, name):
    home = writing.write(name, tmp_path)
    job, truth = load_job(home / "rig" / "job.yaml"), json.loads((home / "truth.json").read_text())
    assert job.name == name and truth["records"] == len(list((home / "rig").iterdir())) - 1
    text = (home / "rig" / "job.yaml").read_text()
    assert not any(effect in text for effect in truth["effects"]) and truth["what"] not in text


def _answer(effects, classes=None, verdict="adequate"):
    steps = [{"added": effect, "class": (classes or {}).get(effect), "rmse": {"validate": 12.0}} for effect in effects]
    steps = [{"rmse": {"validate": 30.0}}, *steps]
    improvement = {"effects": effects, "steps": steps, "verdict": verdict, "unit": "nm"}
    return {"exit": 0, "cpu": 20.0, "improvement": improvement}


TRUTH = {"name": "n36", "kind": "pair", "effects": ["amplifier_lag", "saturation"], "what": "lag", "floors": 18.0}
TRUTH |= {"also_right": {"amplifier_lag": ["sensor_lag"], "saturation": ["quadratic_gain"]}, "noise_um": 0.01}


@pytest.mark.parametrize(
    ("effects", "classes", "exact", "in_class", "wrong"),
    [
        (["saturation", "amplifier_lag"], None, True, True, []),
        (["sensor_lag", "quadratic_gain"], None, False, True, []),
        (["delay", "saturation"], {"delay": ["amplifier_lag"]}, False, True, []),
        (["amplifier_lag", "sensor_lag"], None, False, False, []),
        (["amplifier_lag", "saturation", "creep"], None, False, False, ["creep"]),
        ([], None, False, False, []),
    ],
)
def test_score_takes_right_names_each_for_one_effect(effects, classes, exact, in_class, wrong):
    row = score.score(TRUTH, _answer(effects, classes))
    assert (row["exact"], row["in_class"], row["wrong"]) == (exact, in_class, wrong)
    assert row["floors_left"] == pytest.approx(1.2 if effects else 3.0)


def test_table_has_a_line_for_each_kind_and_each_campaign():
    late = score.score(TRUTH, {"exit": "time", "cpu": 900.0, "improvement": None})
    lines = tally.markdown([score.score(TRUTH, _answer(["saturation", "amplifier_lag"])), late]).splitlines()
    assert lines[2] == "| pair | 2 | 1 | 1 | 0 | 0 | 1.20 / 1.20 | 900 / 900 |"
    assert lines[6].endswith("| saturation, amplifier_lag | adequate | 1.2 | 20 |")
    assert lines[7].endswith("|  | out of time |  | 900 |")
    assert {line.count("|") for line in lines[:3]} == {9} and {line.count("|") for line in lines[4:]} == {8}


def test_reference_rows_are_those_of_its_table():
    folder = FOLDER.parents[1] / "results" / "reference" / "other_labs"
    rows = json.loads((folder / "rows.json").read_text())
    assert tuple(row["name"] for row in rows) == tuple(NAMES)
    assert tally.markdown(rows) == (folder / "table.md").read_text()


def test_simulator_imports_neither_the_package_nor_the_other_simulator():
    allowed = ("from experiments.foreign_effect.solve import solve", "from experiments.foreign_effect.score import")
    for path in FOLDER.glob("*.py"):
        for line in path.read_text().splitlines():
            if line.startswith(("import", "from")):
                assert "pzt_ident" not in line and ("experiments" not in line or line.startswith(allowed))
