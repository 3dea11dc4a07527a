"""The stage with hidden effects against closed forms, and the counting of what was found."""

import ast
import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from experiments.fleet.cluster import TCP
from experiments.hidden_effect import score
from experiments.hidden_effect.__main__ import main
from experiments.hidden_effect.campaign import CAMPAIGNS, Drive, Track
from experiments.hidden_effect.cases import Bench, Sensor
from experiments.hidden_effect.hidden import CATALOGUE, EFFECTS, Dose, respond
from experiments.hidden_effect.stage import Axis, Stage, simulate
from pzt_ident.files import read_files

FOLDER = Path(__file__).parents[2] / "experiments/hidden_effect"
X = Axis(0.1566, 66.0, 7.0028e7, 0.081947, 0.5590, 0.0148, 0.0552)
STAGE = Stage(X, X)
FINE = 5e-6
MODE = math.sqrt(X.stiffness / X.mass) / (2 * math.pi)


def track(rate=1000):
    return Track(rate).ramp(0.25, x=100, y=60).triangles(40, 80, speed=400).ramp(0.1, y=20).rest(0.05)


DRIVE = track().drive("test", "identify")


def response(stage=STAGE, drive=DRIVE):
    return simulate(stage, drive.time, drive.u_x, drive.u_y)


def branch(axis, q, volts):
    """h / (alpha d) counted along the motion, after `volts` of it (the closed form of each sign of q)."""
    if q < 0:
        rate = axis.beta - axis.gamma
        zero = math.log(1 - rate * q) / rate
        q, volts = (0.0, volts - zero) if volts > zero else ((q - 1 / rate) * math.exp(-rate * volts) + 1 / rate, 0.0)
    rate = axis.beta + axis.gamma
    return q if volts == 0 else (q - 1 / rate) * math.exp(-rate * volts) + 1 / rate


def test_the_stage_shares_nothing_with_the_package():
    for path in FOLDER.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(name.split(".")[0] == "pzt_ident" for name in names), path


def test_slow_legs_are_the_closed_branches_of_bouc_wen():
    drive = Track(500).ramp(1, x=100).rest(0.2).ramp(1, x=30).rest(0.2).drive("legs", "identify")
    x, scale = response(drive=drive), X.alpha * X.gain
    up = branch(X, 0.0, 100)
    down = -branch(X, -up, 70)
    ends = x[np.searchsorted(drive.time, [1.19, 2.39])]
    assert ends == pytest.approx([X.gain * 100 - scale * up, X.gain * 30 - scale * down], abs=2e-6)


def test_ring_down_has_the_frequency_and_the_damping_of_the_mode():
    linear = STAGE._replace(x=X._replace(alpha=0.0))
    drive = Track(50000).ramp(2e-5, x=10).rest(0.02).drive("step", "identify")
    ring = response(linear, drive)[100:] - X.gain * 10
    peaks = np.flatnonzero((ring[1:-1] > ring[:-2]) & (ring[1:-1] > ring[2:])) + 100
    assert (len(peaks) - 1) / np.ptp(drive.time[peaks]) == pytest.approx(MODE, rel=2e-3)
    decay = X.damping / (2 * X.mass)
    assert np.abs(ring[500:560]).max() / np.abs(ring[:60]).max() == pytest.approx(math.exp(-decay * 0.01), rel=0.03)


@pytest.mark.parametrize("lag", ["amplifier_lag", "sensor_lag"])
def test_a_lag_trails_a_ramp_by_its_time(lag):
    linear = STAGE._replace(x=X._replace(alpha=0.0))
    drive = Track(1000).ramp(0.1, x=100).drive("ramp", "identify")
    behind = response(linear, drive) - response(linear._replace(**{lag: 4e-4}), drive)
    assert behind[-1] == pytest.approx(X.gain * 1000 * 4e-4, rel=1e-3)


def test_a_delay_is_a_shift():
    late = response(STAGE._replace(delay=0.003))
    assert late[3:] == pytest.approx(response()[:-3], abs=1e-9)
    assert np.all(late[:3] == 0)


def test_creep_grows_by_its_share_each_decade():
    drive = Track(200).ramp(0.005, x=50).rest(11).drive("hold", "identify")
    linear = STAGE._replace(x=X._replace(alpha=0.0))
    x = respond(linear, [Dose("creep", 0.01, {})], drive, 0, 0, 2e-5)
    after = x[np.searchsorted(drive.time, [1.005, 10.005])]
    assert np.diff(after) == pytest.approx([0.01 * 50 * X.gain], rel=0.02)


def test_slew_limit_holds_the_rate():
    linear = STAGE._replace(x=X._replace(alpha=0.0), slew=500.0)
    drive = Track(1000).ramp(0.01, x=100).rest(0.25).drive("jump", "identify")
    x = response(linear, drive)
    assert (x[150] - x[50]) / X.gain == pytest.approx(50, rel=1e-3)
    assert x[-1] == pytest.approx(100 * X.gain, rel=1e-6)


def test_quadratic_gain_and_cubic_stiffness_at_rest():
    plain = response()[-1]
    assert response(STAGE._replace(quadratic=1e-4))[-1] - plain == pytest.approx(1e-4 * 80**2, rel=1e-3)
    stiff = response(STAGE._replace(cubic=1e-3))[-1]
    assert stiff + 1e-3 * stiff**3 == pytest.approx(plain, abs=1e-3)


def test_couplings_agree_at_rest_and_part_when_fast():
    force = response(STAGE._replace(force_coupling=0.05))
    kinematic = response(STAGE._replace(kinematic_coupling=0.05))
    y = response(STAGE, Drive("y", "identify", 1000, DRIVE.u_y, DRIVE.u_x))
    assert force[-1] - response()[-1] == pytest.approx(0.05 * y[-1], abs=2e-4)
    assert kinematic - response() == pytest.approx(0.05 * y, abs=1e-9)


def test_sliding_takes_the_force_of_friction():
    linear = STAGE._replace(x=X._replace(alpha=0.0), friction=0.1, presliding=0.3)
    up = Track(500).ramp(1, x=100).drive("up", "identify")
    assert response(linear, up)[-1] == pytest.approx(100 * X.gain - 0.1, abs=1e-3)


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    """One case, drawn and solved."""
    folder = tmp_path_factory.mktemp("campaign") / "here"
    assert call("draw", "--seed", 11, "--kind", "short", "--effect", "quadratic_gain", "--out", folder).exit_code == 0
    assert call("solve", folder, "--workers", 1).output == ""
    return folder


def call(*line):
    return CliRunner().invoke(main, list(map(str, line)), catch_exceptions=False)


def test_a_case_is_solved_on_a_cluster_to_the_same_bytes(campaign, tmp_path):
    pytest.importorskip("distributed")
    shutil.copytree(campaign / "cases", tmp_path / "cases")
    cluster = TCP(workers=1)
    try:
        assert call("solve", tmp_path, "--on", cluster.address).exit_code == 0
    finally:
        cluster.end()
    here, there = (read_files(folder / "solved" / "short-11" / "improve") for folder in (campaign, tmp_path))
    assert cluster.address in there["environment.json"].decode()
    assert json.loads(there["improvement.json"])["effects"] == ["quadratic_gain"]
    for name in here.keys() - {"environment.json", "events.jsonl"}:
        assert there[name] == here[name], name


def dose(word, share=0.3):
    hidden = EFFECTS[word]
    return Dose(word, share * hidden.most * hidden.signs[-1], hidden.shape(np.random.default_rng(3)))


@pytest.mark.parametrize("word", EFFECTS)
def test_an_effect_without_strength_is_exactly_absent_and_with_it_is_not(word):
    drive, shape = DEEP, dose(word, 0.5)
    plain = respond(STAGE, [], drive, 0, 0.4, 2e-5)
    off = Dose(word, 0.0, shape.shape)
    assert np.array_equal(respond(STAGE, [off], drive, 0, 0.4, 2e-5), plain)
    assert np.ptp(respond(STAGE, [shape], drive, 0, 0.4, 2e-5) - plain) > 1e-4


DEEP = (
    Track(2000)
    .triangles(130, -20, 130, 60, speed=5000)
    .sine(80, 4, x=40)
    .ramp(0.05, x=90, y=50)
    .chirp(100, 900, 0.1, x=4)
    .rest(0.05)
    .drive("deep", "identify")
)


@pytest.mark.parametrize("word", CATALOGUE)
def test_the_null_of_each_quantity_is_the_limit_of_the_effect(word):
    small, smaller = (respond(STAGE, [dose(word, 10.0**-n)], DEEP, 0, 0.0, 2e-5) for n in (4, 6))
    plain = respond(STAGE, [], DEEP, 0, 0.0, 2e-5)
    assert np.abs(smaller - plain).max() <= 0.3 * np.abs(small - plain).max() < 0.01


@pytest.mark.parametrize("word", ["creep", "quadratic_gain", "slew_limit", "periodic_disturbance"])
def test_a_strength_is_scaled_to_the_wanted_size(word):
    bench = Bench(STAGE, [DEEP], 0.005)
    scaled, size = bench.scale(dose(word, 1.0), 2.0)
    assert size == pytest.approx(2.0, rel=0.04)
    assert bench.size(bench.respond([scaled]) - bench.plain) == pytest.approx(size)


def test_what_a_refit_takes_up_has_no_size():
    bench = Bench(STAGE, [DEEP], 0.005)
    wider = STAGE._replace(x=X._replace(gain=1.0001 * X.gain))
    difference = bench.respond([], wider) - bench.plain
    assert bench.size(difference + 1) < 1e-3 < np.std(difference) / 0.005


def test_noise_has_the_sigma_it_says():
    sensor = Sensor(white=0.003, coloured=0.004, correlation=0.002, quantum=0.002, seed=1)
    error = sensor.read(np.zeros(200_000), 1000, 0)
    assert np.std(error) == pytest.approx(math.sqrt(0.003**2 + 0.004**2 + 0.002**2 / 12), rel=0.02)
    assert np.mean(error[1:] * error[:-1]) == pytest.approx(0.004**2 * math.exp(-0.5), rel=0.05)


@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_campaigns_begin_at_rest_and_stay_within_the_driver(campaign):
    drives = CAMPAIGNS[campaign](np.random.default_rng(2))
    assert {drive.use for drive in drives} == {"identify", "validate"}
    for drive in drives:
        assert drive.u_x[0] == drive.u_y[0] == 0
        assert min(drive.u_x.min(), drive.u_y.min()) >= -20 and max(drive.u_x.max(), drive.u_y.max()) <= 150
        still = (np.diff(drive.u_x) == 0) & (np.diff(drive.u_y) == 0)
        assert still.sum() / drive.rate >= 0.01


def test_draw_is_a_function_of_its_seed_and_seals_the_truth(tmp_path):
    for folder in ("a", "b"):
        line = ["draw", "--seed", "5", "--kind", "short", "--effect", "creep", "--out", str(tmp_path / folder)]
        assert CliRunner().invoke(main, line, catch_exceptions=False).exit_code == 0
    for path in (tmp_path / "a").rglob("*.*"):
        assert path.read_bytes() == (tmp_path / "b" / path.relative_to(tmp_path / "a")).read_bytes()
    case = tmp_path / "a" / "cases" / "short-5"
    assert "creep" not in (case / "job.yaml").read_text(encoding="utf-8")
    truth = json.loads((tmp_path / "a" / "sealed" / "short-5.json").read_text(encoding="utf-8"))
    assert [entry["effect"] for entry in truth["effects"]] == ["creep"]
    assert (case / "first.csv").read_text(encoding="utf-8").startswith("time [s],u_x [V],u_y [V],x [um]\n")


def solved(folder, name, hidden, found, verdict="adequate"):
    """A case with its truth and an improvement that found (effect, class) one after the other."""
    rmse = [{"identify": 0.05 / (n + 1), "validate": 0.06 / (n + 1)} for n in range(len(found) + 1)]
    steps = [{"added": None, "removed": None, "class": [], "rmse": rmse[0], "explained": 0.0}]
    for (word, alike), one in zip(found, rmse[1:], strict=True):
        steps.append({"added": word, "removed": None, "class": alike, "rmse": one, "explained": 0.9})
    effects = [word for word, _ in found]
    improvement = {"steps": steps, "verdict": verdict, "effects": effects, "noise_floor": {"x": 0.01}, "unit": "um"}
    truth = {
        "name": name,
        "kind": name.rpartition("-")[0],
        "noise_floor": 0.01,
        "effects": [{"effect": word, "size": 9.0} for word in hidden],
    }
    for path, content in (
        (folder / "solved" / name / "improve" / "improvement.json", improvement),
        (folder / "sealed" / f"{name}.json", truth),
    ):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(content), encoding="utf-8")


def test_counting(tmp_path):
    lags = ["amplifier_lag", "sensor_lag"]
    solved(tmp_path, "single-1", ["creep"], [("creep", ["creep"])])
    solved(tmp_path, "single-2", ["sensor_lag"], [("amplifier_lag", lags)])
    solved(tmp_path, "single-3", ["delay"], [("amplifier_lag", lags)])
    solved(tmp_path, "pair-1", ["creep", "delay"], [("creep", ["creep"]), ("drift", ["drift"])], "unexplained")
    solved(tmp_path, "none-1", [], [])
    solved(tmp_path, "outside-1", ["depoling"], [], "unexplained")
    (tmp_path / "sealed" / "triple-1.json").write_text("{}", encoding="utf-8")
    line = CliRunner().invoke(main, ["score", str(tmp_path)], catch_exceptions=False)
    found = json.loads(line.output)
    rows = {row["kind"]: row for row in found["kinds"]}
    assert found["failed"] == ["triple-1"] and rows["triple"]["exact"] == 0
    assert [rows["single"][key] for key in ("exact", "inside")] == pytest.approx([1 / 3, 2 / 3], abs=1e-3)
    assert [rows["single"][key] for key in ("false_alarms", "missed")] == [1, 1]
    assert [rows["pair"][key] for key in ("exact", "false_alarms", "missed")] == [0, 1, 1]
    assert rows["none"]["exact"] == rows["none"]["adequate"] == rows["outside"]["unexplained"] == 1
    assert rows["single"]["validate_median"] == pytest.approx(3)
    assert (tmp_path / "score" / "confusion.csv").read_text(encoding="utf-8").startswith("hidden,")
    assert {path.name for path in (tmp_path / "score").glob("*.svg")} == {"confusion.svg", "staircases.svg"}


def test_as_many_pairs_as_there_can_be():
    classes = {"a": frozenset("abc"), "b": frozenset("bd")}
    found = score.Answer(("a", "b"), classes, "adequate")
    assert set(score.match(("c", "d"), found)) == {("c", "a"), ("d", "b")}
    assert set(score.match(("d", "c"), found)) == {("c", "a"), ("d", "b")}


def test_one_case_from_the_draw_to_the_score(campaign):
    found = json.loads(call("score", campaign).output)
    assert found["failed"] == []
    (row,) = found["kinds"]
    assert [row[key] for key in ("kind", "cases", "exact", "adequate")] == ["short", 1, 1, 1]
    assert row["validate_median"] < 1.5
    steps = json.loads((campaign / "solved/short-11/improve/improvement.json").read_text(encoding="utf-8"))["steps"]
    assert [step["added"] for step in steps] == [None, "quadratic_gain"]
    assert steps[0]["rmse"]["validate"] > 5 * steps[1]["rmse"]["validate"]
