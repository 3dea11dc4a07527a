"""Effects that are laid into measurements against closed forms, and one case from its file to its score."""

import json
import os

import numpy as np
import pytest

from experiments.laid_in import cases, score
from experiments.laid_in.effects import EFFECTS, WORDS, Response, lay, scale, seen
from experiments.laid_in.records import RECORDS

DT = 1e-3
T = np.arange(4000) * DT
measured = pytest.mark.skipif("PZT_IDENT_DATA" not in os.environ, reason="PZT_IDENT_DATA names no measurements")


def after(effect, size, values, hint=1.0, **more):
    (found,) = lay(effect, size, [Response(values, DT, **more)], 3, hint)
    return found


def test_a_lag_of_a_ramp_is_behind_by_tau_and_a_delay_by_its_time():
    assert after("lag", 0.02, 5 * T)[-1] == pytest.approx(5 * (T[-1] - 0.02), abs=1e-9)
    np.testing.assert_allclose(after("delay", 0.0123, 5 * T)[20:], 5 * (T[20:] - 0.0123), atol=1e-9)


@pytest.mark.parametrize(("effect", "gain"), [("lag", 1 / (1 + 0.004j * 20)), ("delay", np.exp(-0.004j * 20))])
def test_a_period_is_that_of_the_steady_state(effect, gain):
    t = np.arange(1000) * 2 * np.pi / 20 / 1000
    (found,) = lay(effect, 0.004, [Response(np.cos(20 * t), t[1], periodic=True)], 3, 0)
    np.testing.assert_allclose(found, (gain * np.exp(20j * t)).real, atol=1e-12)


def test_creep_after_a_step_ends_at_its_share():
    step = np.concatenate([np.zeros(100), np.ones(3900)])
    found = after("creep", 0.1, step, hint=0.1, rest=100)
    assert found[100] == pytest.approx(1.0, abs=2e-3) and found[-1] == pytest.approx(1.1, abs=1e-4)
    assert np.all(np.diff(found[100:]) > -1e-12)


def test_a_change_that_a_gain_and_an_offset_take_up_is_not_seen():
    wave = Response(np.sin(9 * T), DT)
    assert seen([1.3 * wave.values + 0.4], [wave]) < 1e-12
    assert seen([wave.values + 0.2 * np.cos(9 * T)], [wave]) == pytest.approx(0.2 / np.sqrt(2), rel=0.02)


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_is_scaled_to_what_is_seen_of_it(effect):
    wave = [Response(10 * np.sin(9 * T), DT)]
    hint = {"hum": 50.0, "encoder": 3.0, "drift": 2.0, "bend": 0.0}.get(effect, 0.1)
    size = scale(effect, 0.05, wave, 3, hint)
    assert seen(lay(effect, size, wave, 3, hint), wave) == pytest.approx(0.05, rel=0.05)
    assert scale(effect, 1e3, wave, 3, hint) is None


def answer(*named, tied=(), suspects=(), late=0.0):
    steps = [{"added": None, "class": [], "rmse": {"validate": 0.3}, "parameters": {}}]
    parameters = {"delay.time": {"value": late, "unit": "s"}}
    steps += [{"added": e, "class": [e, *tied], "rmse": {"validate": 0.1}, "parameters": parameters} for e in named]
    found = {"effects": list(named), "steps": steps, "suspects": [{"effect": name} for name in suspects]}
    return {"improvement": found | {"verdict": "unexplained", "reason": "", "unit": "um"}, "cpu": 1.0}


def test_score_knows_exact_from_tied_from_suspected_from_missed_and_what_was_lacked_anyway():
    truth = {"record": "stack", "effect": "bend", "units": 5, "size": 1e-3}
    own = answer("creep", late=0.001)

    def row(*named, effect="bend", **more):
        return score.score(truth | {"effect": effect}, answer("creep", *named, late=0.003, **more), own)

    assert row("quadratic_gain")["outcome"] == "exact" and row("quadratic_gain")["other"] == []
    assert row("saturation", tied=["quadratic_gain"])["outcome"] == "in class"
    assert row(suspects=["quadratic_gain"])["outcome"] == "suspect"
    missed = row("friction")
    assert (missed["outcome"], missed["other"], missed["kept"]) == ("missed", ["friction"], ["creep"])
    assert row("quadratic_gain")["later"] == pytest.approx(0.002) and not row()["known"]
    assert row(effect="creep")["known"] and row(effect="creep")["outcome"] == "exact"


def test_every_record_names_effects_that_there_are():
    assert set(WORDS) == set(EFFECTS) and all(set(record.hints) <= set(EFFECTS) for record in RECORDS.values())


@measured
@pytest.mark.parametrize("record", ["stack", "capacitor"])
def test_a_case_holds_the_job_and_the_readings_that_were_laid_in(record, tmp_path):
    home = cases.write(record, "bend", 5, 3, tmp_path)
    truth, chosen = json.loads((home / "truth.json").read_text()), RECORDS[record]
    job = (home / "rig" / "job.yaml").read_text()
    assert "PZT_IDENT_DATA" not in job and truth["size"] > 0
    file = next(path for path in sorted((home / "rig").rglob("*")) if path.suffix in (".dat", ".tsv"))
    assert str(file.relative_to(home / "rig")) in job
    readings = np.loadtxt(file, skiprows=int(record == "capacitor"))[:, 4]
    plain = [part.values for part in chosen.read() if part.values.size == readings.size]
    laid = [y + truth["size"] * (y - chosen.hints["bend"]) ** 2 for y in plain]
    assert min(np.abs(y - readings).max() for y in laid) < 1e-6
