"""Records that begin in motion: the drive ahead of them goes on in them, and other kinds have none."""

import json

import numpy as np
import pytest

from experiments.foreign_effect import ahead, cases, score, tally
from experiments.foreign_effect.campaign import DRIVES, Record, drive
from experiments.foreign_effect.stage import Axis, simulate
from experiments.foreign_effect.visibility import MOST_STEPS, Rig

RANGES = {"x": (-10.0, 100.0), "y": (0.0, 80.0)}
BOUC_WEN = {"kind": "bouc_wen", "gain": 0.1, "alpha": 0.4, "beta": 0.05, "gamma": 0.02}
CREEP = {"form": "kelvin_voigt", "size": 0.1, "times": [0.3], "weights": [1.0]}


def record(way, kind="triangle", seed=1, rate=1000.0, moves=True):
    """A record of two axes with a drive ahead of it, and the largest step of each drive as it was drawn."""
    rng = np.random.default_rng(seed)
    drives = {"x": drive(rng, kind, 900, rate, *RANGES["x"]), "y": np.zeros(900)}
    if moves:
        drives["y"] = drive(rng, "sines", 900, rate, *RANGES["y"])
    out = Record(kind, "identify", rate, drives)
    steps = {axis: np.max(np.abs(np.diff(u))) for axis, u in drives.items()}
    ahead.WAYS[way](rng, out, RANGES)
    return out, steps


@pytest.mark.parametrize("way", ahead.WAYS)
@pytest.mark.parametrize("kind", DRIVES)
def test_the_drive_does_not_jump_where_a_record_begins_and_stays_in_its_range(way, kind):
    for seed in range(3):
        begun, steps = record(way, kind, seed, moves=seed != 2)
        assert begun.samples == 900 and begun.lead > 50
        for axis, u in begun.run.items():
            assert len(u) == begun.lead + 900 and abs(u[0]) < 1e-6
            assert np.max(np.abs(np.diff(u))) <= steps[axis] * (1 + 1e-9)
            assert RANGES[axis][0] - 15 < u.min() and u.max() < RANGES[axis][1] + 15
        assert np.ptp(begun.run["y"]) > 0 or seed == 2


def test_each_way_is_what_it_is_called():
    cut, _ = record("cut")
    after, _ = record("after")
    assert np.array_equal(cut.run["x"][:900], after.drives["x"]) and abs(cut.drives["x"][0]) > 1
    rest = len(after.ahead["x"]) - 1 - np.flatnonzero(np.diff(after.ahead["x"]))[-1]
    assert 200 <= rest <= 2001 and after.ahead["x"][-1] == after.drives["x"][0]
    cycled, _ = record("cycled")
    near = {end: np.abs(cycled.ahead["x"] - end) < 3.0 for end in RANGES["x"]}
    assert {end: int(np.sum(np.diff(np.append(0, seen)) > 0)) for end, seen in near.items()} == {-10.0: 3, 100.0: 3}
    assert np.diff(cycled.run["x"])[cycled.lead - 1] != 0


def test_a_rest_at_a_quick_rate_is_short():
    after, _ = record("after", rate=50000.0)
    assert 10000 < after.lead < 12000


@pytest.mark.parametrize("way", ahead.WAYS)
def test_readings_are_the_tail_of_a_simulation_of_the_whole_drive(way):
    begun, _ = record(way)
    axes = {"x": Axis(dict(BOUC_WEN), [(60.0, 0.03, 1.0)], {"creep": CREEP}), "y": Axis(dict(BOUC_WEN), [])}
    axes["x"].effects["amplifier_lag"] = {"form": "one_pole", "size": 3e-3}
    axes["x"].effects["cross_coupling"] = {"form": "displacement", "size": 0.1}
    rest = simulate(axes, begun.drives, 1e-3, 2)
    whole = simulate(axes, begun.run, 1e-3, 2)
    seen = simulate(axes, begun.run, 1e-3, 2, lead=begun.lead)
    for axis in axes:
        assert len(seen[axis]) == 900
        assert np.max(np.abs(seen[axis] - whole[axis][begun.lead :])) < 1e-9
        assert np.max(np.abs(seen[axis] - rest[axis])) > 0.05


def test_drift_and_the_phase_of_hum_begin_with_the_first_sample():
    begun, _ = record("cut")
    plain = {"x": Axis(dict(BOUC_WEN), [])}
    drives, lead = {"x": begun.run["x"]}, begun.lead
    still = simulate(plain, drives, 1e-3, 2, lead=lead)["x"]
    t = np.arange(900) * 1e-3
    plain["x"].effects = {"drift": {"form": "exponential", "size": 0.3, "time": 0.2}}
    moved = simulate(plain, drives, 1e-3, 2, lead=lead)["x"]
    assert np.max(np.abs(moved - still - 0.3 * (1 - np.exp(-t / 0.2)))) < 1e-9
    tone = {"form": "output", "size": 0.2, "frequency": 20.0, "phases": [1.0], "third": 0.0}
    plain["x"].effects = {"periodic_disturbance": tone}
    moved = simulate(plain, drives, 1e-3, 2, lead=lead)["x"]
    assert np.max(np.abs(moved - still - 0.2 * np.sin(2 * np.pi * 20 * t + 1))) < 1e-9


def test_a_case_has_its_way_in_the_truth_alone_and_its_clock_from_the_first_sample(tmp_path):
    home = cases.write("begun", 3, tmp_path)
    truth, job = json.loads((home / "truth.json").read_text()), (home / "rig" / "job.yaml").read_text()
    assert truth["ahead"] in ahead.WAYS and len(truth["truth"]) == 1
    assert "settle" not in job and "ahead" not in job and "history" not in job
    case = cases.draw("begun", 3)
    alone = Rig(case)
    for i, (begun, clean) in enumerate(zip(case["records"], case["clean"], strict=True)):
        assert begun.lead > 0
        first = alone._fine(begun, case["axes"]["x"].effects)
        counts = [first * 2**n for n in range(8) if first * 2**n <= MOST_STEPS]
        wholes = (simulate(case["axes"], begun.run, 1 / begun.rate, n, i, case["noise_seed"])["x"] for n in counts)
        assert any(np.max(np.abs(clean["x"] - whole[begun.lead :])) < 1e-9 for whole in wholes)
    files = sorted((home / "rig").glob("01_*.csv"))
    rows = np.loadtxt(files[0], delimiter=",", skiprows=1)
    assert rows[0, 0] == 0 and rows[:, 1] == pytest.approx(case["records"][0].drives["x"], abs=1e-6)


def test_kinds_that_were_there_before_draw_what_they_drew():
    case = cases.draw("single", 10000)
    sizes = case["sizes"][case["truth"][0]]
    drawn = (sizes["size"], case["floor"], float(np.sum(case["clean"][0]["x"])))
    assert (case["truth"], sizes["form"], case["noise_seed"]) == (["asymmetry"], "constant", 526625142)
    assert drawn == pytest.approx((0.6, 0.00950541152568354, 32913.19493606314), rel=1e-9)
    assert not any(r.ahead for r in case["records"])
    assert len(set(cases.KINDS.values())) == len(cases.KINDS)


def test_begun_is_scored_like_single_and_begun_none_like_none():
    truth = {"seed": 1, "base": {"kind": "plays"}, "bounds": "wide", "mechanics": "none", "y": None, "floor": 0.01}
    truth |= {"sensor": {"memory": 0}, "sizes": None, "seen": {}}

    def row(kind, true, way, *named):
        steps = [{"added": e, "rmse": {"identify": 0.01, "validate": 0.01}} for e in (None, *named)]
        answer = {"effects": list(named), "steps": steps, "verdict": "adequate"}
        sizes = {e: {"form": "voltage"} for e in true} or None
        whole = truth | {"kind": kind, "truth": true, "sizes": sizes} | ({"ahead": way} if way else {})
        return score.score(whole, {"improvement": answer, "cpu": 1.0, "seconds": 1.0, "exit": 0})

    rows = [row("begun", ["creep"], "cut", "creep"), row("begun", ["creep"], "cut", "drift")]
    rows += [row("begun_none", [], "after"), row("begun_none", [], "cycled", "creep"), row("none", [], None)]
    text = tally.markdown(rows)
    assert "| begun | 2 | 1/2 | 1/2 | 1 |" in text and "| begun_none | 2 | 1/2 | 1/2 | 1 |" in text
    assert "| begun: cut | 2 | 1/2 |" in text and "| begun_none: after | 1 | 1/1 |" in text
    assert "| ahead |" not in tally.markdown(rows[-1:])
