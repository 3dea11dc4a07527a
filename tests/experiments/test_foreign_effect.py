"""The foreign stage against closed forms, and its lottery against itself. It never meets the package."""

import itertools
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from experiments.foreign_effect import campaign, cases, effects, follow, mechanics, operators, score, tally
from experiments.foreign_effect.campaign import DRIVES, Record, drive, floor, noise, read
from experiments.foreign_effect.family import Family
from experiments.foreign_effect.forms import FORMS, NEEDS
from experiments.foreign_effect.stage import Axis, simulate
from experiments.foreign_effect.visibility import SETTLED, Rig, Unsettled

FOLDER = Path(operators.__file__).parent
BOUC_WEN = {"kind": "bouc_wen", "gain": 0.1, "alpha": 0.4, "beta": 0.05, "gamma": 0.02}


def triangle(*turns, each=200):
    return np.concatenate([np.linspace(a, b, each, endpoint=False) for a, b in itertools.pairwise(turns)])


def axis_with(effect, form, size, c, rng, modes=()):
    plan, *_ = FORMS[effect][form](rng, c)
    return Axis(dict(BOUC_WEN), list(modes), {effect: plan | {"form": form, "size": size}})


@pytest.fixture
def surroundings():
    return {
        "gain": 0.1, "top": 100.0, "stroke": 10.0, "beta": 0.05, "gamma": 0.02, "fastest": 1000.0, "longest": 2.0,
        "records": 2, "speed": 400.0, "swiftest": 1000.0, "f1": 60.0,
    }  # fmt: skip


def test_bouc_wen_saturates_at_alpha_d_over_beta_plus_gamma():
    u = triangle(0, 1000, -1000, 0)
    h = 0.1 * u - operators.bouc_wen(u, 0.1, 0.4, 0.05, 0.02)
    assert h.max() == pytest.approx(0.4 * 0.1 / 0.07, rel=1e-9)
    assert h.min() == pytest.approx(-0.4 * 0.1 / 0.07, rel=1e-9)


@pytest.mark.parametrize(("beta", "gamma"), [(0.05, 0.02), (0.02, 0.06), (0.03, 0.03)])
def test_bouc_wen_solves_its_equation(beta, gamma):
    def rates(t, h):
        slope = 80 * math.cos(2 * t)
        return 0.04 * slope - beta * abs(slope) * h - gamma * slope * abs(h)

    t = np.linspace(0, 6, 6001)
    h = solve_ivp(rates, (0, 6), [0.0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.01).y[0]
    u = 40 * np.sin(2 * t)
    assert np.max(np.abs(0.1 * u - operators.bouc_wen(u, 0.1, 0.4, beta, gamma) - h)) < 2e-6


def test_bouc_wen_does_not_depend_on_the_rate_or_on_the_division_of_a_path():
    u = triangle(0, 100, 20, 70, 0)
    fine = operators.bouc_wen(np.interp(np.arange(3 * len(u) - 2) / 3, np.arange(len(u)), u), 0.1, 0.4, 0.05, 0.02)
    assert np.max(np.abs(fine[::3] - operators.bouc_wen(u, 0.1, 0.4, 0.05, 0.02))) < 1e-12


def test_generalised_bouc_wen_with_a_sign_of_the_rate_alone_has_unequal_branches():
    u = triangle(0, 1000, -1000, 0)
    h = 0.1 * u - operators.bouc_wen(u, 0.1, 0.4, 0.05, 0.02, shape={"b4": 0.01})
    assert h.max() == pytest.approx(0.04 / 0.08, rel=1e-9)
    assert h.min() == pytest.approx(-0.04 / 0.06, rel=1e-9)


def test_plays_close_minor_loops():
    u = triangle(0, 100, 40, 70, 40, 100, 0)
    y = operators.prandtl_ishlinskii(u, 0.05, [0.02, 0.03], [5.0, 20.0])
    assert y[400] == pytest.approx(y[800], abs=1e-12)  # 40 V ahead of the minor loop and after it, at the lower turn
    assert operators.plays(triangle(0, 50), [5.0])[-1, 0] == pytest.approx(triangle(0, 50)[-1] - 5)


@pytest.mark.parametrize("law", ["lognormal", "normal"])
def test_preisach_wipes_out_what_a_larger_extreme_passes(law):
    table = operators.everett_table(3.0, 12.0, 0.4, 60.0, law, 250.0, points=120)
    plain = operators.preisach_density(triangle(0, 90, 10), 0.1, table)
    nested = operators.preisach_density(triangle(0, 80, 30, 60, 40, 90, 10), 0.1, table)
    assert nested[-1] == pytest.approx(plain[-1], abs=1e-9)
    assert abs(plain[0]) < 0.01 * np.ptp(plain)


def test_preisach_and_free_energy_of_one_density_agree():
    u = triangle(0, 90, 10, 70, -20, each=60)
    table = operators.everett_table(3.0, 12.0, 0.4, 60.0, "lognormal", 250.0)
    two = operators.free_energy(u, 0.1, 3.0, 12.0, 0.4, 60.0)
    assert np.max(np.abs(operators.preisach_density(u, 0.1, table) - two)) < 3e-3 * 3.0


@pytest.mark.parametrize("first", [0.3, 5.0, 40.0, -0.3, -40.0])
def test_preisach_keeps_its_demagnetised_memory_whichever_way_the_drive_sets_out(first):
    u = np.concatenate([[0.0], triangle(first, 60, -10, 45, 5, each=40)])
    table = operators.everett_table(3.0, 12.0, 0.4, 60.0, "lognormal", 250.0)
    two = operators.free_energy(u, 0.1, 3.0, 12.0, 0.4, 60.0)
    assert np.max(np.abs(operators.preisach_density(u, 0.1, table) - two)) < 3e-3 * 3.0
    assert np.max(np.abs(operators.rayleigh(u, 1e-3) + operators.rayleigh(-u, 1e-3))) < 0.02


def test_thermal_activation_vanishes_with_its_temperature_and_creeps_with_it():
    u = np.concatenate([triangle(0, 60), np.full(400, 60.0)])
    cold = operators.free_energy(u, 0.1, 3.0, 12.0, 0.4, 60.0, dt=0.01, theta=1e-3, speed=40.0)
    still = operators.free_energy(u, 0.1, 3.0, 12.0, 0.4, 60.0)
    warm = operators.free_energy(u, 0.1, 3.0, 12.0, 0.4, 60.0, dt=0.01, theta=1.0, speed=40.0)
    assert np.max(np.abs(cold - still)) < 0.01
    gain = np.diff(warm[[220, 240, 280, 360]])
    assert (gain > 0).all() and np.allclose(gain, gain.mean(), rtol=0.35)  # nearly equal for each doubling of time


def test_rayleigh_loop_has_the_area_of_rayleigh():
    u = triangle(0, 50, -50, 50, -50)
    loop = operators.rayleigh(u, 2e-3)[-400:]
    area = abs(np.trapezoid(np.append(loop, loop[0]), np.append(u[-400:], u[-400])))
    assert area == pytest.approx(2 / 3 * 2e-3 * 4 * 50**3 / 2, rel=0.02)


def test_kelvin_voigt_creeps_exponentially_after_a_step():
    f = np.concatenate([[0.0], np.ones(2000)])
    y = effects.kelvin_voigt(f, 0.01, [0.1], [2.0])
    t = np.arange(2000) * 0.01
    edge = 1 - 2.0 / 0.01 * (1 - math.exp(-0.01 / 2.0))
    assert y[1] == pytest.approx(1 + 0.1 * edge, abs=1e-9)
    assert np.max(np.abs(y[1:] - 1 - 0.1 * (1 - (1 - edge) * np.exp(-t / 2.0)))) < 1e-9


def test_logarithmic_creep_rises_by_its_share_a_decade():
    f = np.concatenate([[0.0], np.ones(20000)])
    y = effects.logarithmic_creep(f, 0.01, 0.02, 0.1, 200.0)
    assert y[10001] - y[1001] == pytest.approx(0.02, rel=0.1)


def test_delay_shifts_and_lag_of_a_ramp_is_behind_by_tau():
    t = np.arange(2000) * 1e-3
    assert np.max(np.abs(effects.delay(t, t, 0.0123)[20:] - (t[20:] - 0.0123))) < 1e-12
    assert mechanics.lag(t, 1e-3, 0.01, 2)[-1] == pytest.approx(t[-1] - 0.01, abs=1e-9)
    assert effects.sensor_lag(t, 1e-3, "two_order", 0.01)[-1] == pytest.approx(t[-1] - 0.01, abs=1e-9)


def test_slew_limit_clips_the_rate_and_only_that():
    u = triangle(0, 1, 0, each=1000)
    assert np.max(np.abs(np.diff(effects.rate_clip(u, 1e-3, 0.5)))) <= 0.5e-3 + 1e-12
    assert np.array_equal(effects.rate_clip(u, 1e-3, 2.0), u)
    quick = effects.saturating_lag(np.append(0.0, np.ones(3000)), 1e-3, 0.5, 1e-3)
    assert np.max(np.diff(quick)) == pytest.approx(0.5e-3, rel=1e-6)


def test_mode_answers_a_ramp_and_rings_at_its_frequency():
    t = np.arange(4000) * 1e-4
    y = mechanics.mode(np.minimum(t / 1e-4, 1.0), 1e-4, 100.0, 0.02)
    crossings = np.flatnonzero((y[1:] > 1) & (y[:-1] <= 1))
    assert 1 / (np.mean(np.diff(crossings)) * 1e-4) == pytest.approx(100 * math.sqrt(1 - 0.02**2), rel=0.01)
    assert np.max(np.abs(mechanics.motion(np.minimum(t / 1e-4, 1.0), 1e-4, 100.0, 0.02) - y)) < 1e-4


def test_dahl_ahead_levels_off_at_its_level_and_static_cubic_solves_its_equation():
    f = triangle(0, 10, 0)
    law = {"kind": "dahl", "place": "ahead", "level": 0.2, "stiffness": 0.4}
    assert (f - mechanics.friction_ahead(f, 1e-3, law)).max() == pytest.approx(0.2, rel=1e-4)
    x = mechanics.static_cubic(f, 1e-3)
    assert np.max(np.abs(x + 1e-3 * x**3 - f)) < 1e-12


@pytest.mark.parametrize("start", [0.0, 3.0, -4.0])
def test_a_flexure_bends_about_the_same_zero_wherever_a_record_starts(start):
    f = start + 4 * np.sin(2 * np.pi * np.arange(16000) / 16000)
    x = mechanics.motion(f, 1e-3, 60.0, 0.3, cubic=2e-3)
    assert np.max(np.abs(x - mechanics.static_cubic(f, 2e-3))) < 5e-3


def _identity_cases():
    for effect, forms in FORMS.items():
        for form in forms:
            yield effect, form


@pytest.mark.parametrize(("effect", "form"), list(_identity_cases()))
def test_every_form_is_nearly_the_identity_near_its_null(effect, form, surroundings):
    rng = np.random.default_rng(5)
    modes = [(60.0, 0.03, 1.0)]
    u = {"x": drive(rng, "nested", 500, 1000, 0, 100), "y": drive(rng, "sines", 500, 1000, 0, 100)}
    plain = {"x": Axis(dict(BOUC_WEN), modes), "y": Axis(dict(BOUC_WEN), modes)}
    if effect == "thermal_relaxation" and form == "arrhenius":
        base = {
            "kind": "free_energy",
            "gain": 0.1,
            "remanence": 3.0,
            "coercive": 12.0,
            "spread": 0.4,
            "interaction": 60.0,
        }
        plain["x"] = Axis(base, modes)
    _, low, _, _ = FORMS[effect][form](rng, surroundings)
    still = simulate(plain, u, 1e-3, 4)["x"]
    sides = []
    for size in (low, low / 8):
        changed = axis_with(effect, form, size, surroundings, np.random.default_rng(6), modes)
        changed.base = plain["x"].base
        sides.append(np.sqrt(np.mean((simulate({"x": changed, "y": plain["y"]}, u, 1e-3, 4)["x"] - still) ** 2)))
    assert 0 < sides[0] < 1.0
    assert sides[1] <= 0.5 * sides[0]  # and gone at zero, as near as its form is smooth
    null = axis_with(effect, form, 0.0, surroundings, np.random.default_rng(6), modes)
    null.base = plain["x"].base
    assert np.max(np.abs(simulate({"x": null, "y": plain["y"]}, u, 1e-3, 4)["x"] - still)) < 1e-9


def test_noise_has_its_level_and_its_memory():
    rng = np.random.default_rng(1)
    white, coloured = noise(rng, 200000, 0.01, 0.0), noise(rng, 200000, 0.01, 0.9)
    assert white.std() == pytest.approx(0.01, rel=0.01) and coloured.std() == pytest.approx(0.01, rel=0.03)
    assert np.corrcoef(coloured[1:], coloured[:-1])[0, 1] == pytest.approx(0.9, abs=0.01)
    sensor = {"sigma": 0.01, "memory": 0.0, "count": 0.02}
    ramp = np.linspace(0, 10, 100000)
    assert (read(ramp, rng, sensor) - ramp).std() == pytest.approx(floor(sensor), rel=0.01)


@pytest.mark.parametrize("kind", DRIVES)
def test_drives_begin_at_rest_and_stay_in_their_range(kind):
    for seed in range(4):
        u = drive(np.random.default_rng(seed), kind, 3000, 1000, -10, 100, rest=100)
        assert len(u) == 3000 and abs(u[0]) < 1e-6 and np.ptp(u[:100]) == 0
        assert u.min() > -25 and u.max() < 112


def test_two_draws_of_one_seed_agree_and_are_answered_from_the_rig_folder_alone(tmp_path):
    homes = [cases.write("single", 7, tmp_path / name) for name in ("a", "b")]
    files = [sorted(p.relative_to(h) for p in h.rglob("*") if p.is_file()) for h in homes]
    assert files[0] == files[1]
    for name in files[0]:
        if name.name != "truth.json":
            assert (homes[0] / name).read_bytes() == (homes[1] / name).read_bytes()
    truth = json.loads((homes[0] / "truth.json").read_text())
    assert not list((homes[0] / "rig").glob("*truth*"))
    assert all(effect not in (homes[0] / "rig" / "job.yaml").read_text() for effect in truth["truth"])
    assert max(max(seen) for seen in truth["seen"].values()) >= 3


def test_score_knows_exact_from_tied_from_wrong():
    truth = {"kind": "single", "seed": 1, "truth": ["amplifier_lag"], "base": {"kind": "plays"}, "bounds": "wide"}
    truth |= {"mechanics": "none", "y": None, "sensor": {"memory": 0}, "sizes": {}, "seen": {}, "floor": 0.01}

    def row(*named, tied=()):
        steps = [{"added": None, "class": [], "rmse": {"identify": 0.2, "validate": 0.3}}]
        steps += [{"added": e, "class": [e, *tied], "rmse": {"identify": 0.01, "validate": 0.01}} for e in named]
        answer = {"effects": list(named), "steps": steps, "verdict": "adequate"}
        return score.score(truth, {"improvement": answer, "cpu": 1.0, "seconds": 1.0, "exit": 0})

    assert row("amplifier_lag")["exact"] and row("amplifier_lag")["in_class"]
    tied = row("sensor_lag", tied=("amplifier_lag",))
    assert not tied["exact"] and tied["in_class"] and not tied["extra"]
    assert not row("sensor_lag")["in_class"] and row("sensor_lag")["extra"] == ["sensor_lag"]
    assert not row("amplifier_lag", "creep")["in_class"]
    assert row("amplifier_lag")["floors"] == 1.0


def test_tables_count_the_memory_the_effect_beside_it_and_ties_that_are_gone():
    truth = {"seed": 1, "base": {"kind": "plays"}, "bounds": "wide", "mechanics": "none", "y": None, "floor": 0.01}
    truth |= {"sensor": {"memory": 0}, "sizes": {"creep": {"form": "voltage"}}, "seen": {"creep": [4.0]}}

    def row(kind, true, *named, tied=()):
        steps = [{"added": None, "rmse": {"identify": 0.2, "validate": 0.3}}]
        steps += [{"added": e, "class": [e, *tied], "rmse": {"identify": 0.01, "validate": 0.01}} for e in named]
        answer = {"effects": list(named), "steps": steps, "verdict": "adequate"}
        leaves = {"bouc_wen": {key: {"all": 5.0} for key in ("alone", "with_plays")}}
        whole = truth | {"kind": kind, "truth": true} | (leaves if kind == "family" else {})
        return score.score(whole, {"improvement": answer, "cpu": 1.0, "seconds": 1.0, "exit": 0})

    hidden = ["distributed_memory", "creep"]
    text = tally.markdown([row("family", hidden, *hidden), row("family", hidden, "creep")])
    assert "| with one effect | 2 | 1/2 | 1/2 | 2/2 | 2/2 | 0 |" in text
    first = row("loops", ["creep"], "drift", tied=["creep"])
    text = tally.markdown([first | {"followed": row("loops", ["creep"], "creep")}, row("loops", ["creep"], "creep")])
    assert "| loops | 2 | 1 | 1/1 | 1/1 | 1/1 | 1/1 | 1/1 |" in text
    text = tally.markdown([first | {"followed": row("loops", ["creep"], "drift")}])
    assert "| loops | 1 | 1 | 1/1 | 1/1 | 1/1 | 0/1 | 0/1 |" in text


def test_one_frequency_is_one_line_and_its_harmonics_and_starts_at_rest():
    for shape in ("triangle", "sines"):
        u = campaign.one_tone(np.arange(4000) * 1e-3, -20.0, 100.0, 0.4, shape)
        assert abs(u[0]) < 1e-9 and u[1] > 0 and np.ptp(u) == pytest.approx(120, abs=1)
        lines = np.abs(np.fft.rfft(u))
        assert set(np.flatnonzero(lines > 1e-6 * lines.max()) % 10) == {0}


def family(base):
    """The rig of a family case with one record of either use."""
    u = drive(np.random.default_rng(3), "nested", 900, 500, 0, 100)
    records = [
        Record("nested", "identify", 500.0, {"x": u}),
        Record("nested", "validate", 500.0, {"x": u[::-1].copy()}),
    ]
    sensor = {"sigma": 1e-3, "memory": 0.0, "count": 0.0}
    rig = Family({"axes": {"x": Axis(base, [])}, "records": records, "sensor": sensor, "truth": [], "noise_seed": 1})
    rig.hold_base()
    return rig


def test_bouc_wen_is_no_other_family_than_itself_and_the_ten_plays_hold_ten_plays():
    rig = family(dict(BOUC_WEN))
    assert rig.nearest_bouc_wen() == pytest.approx({k: v for k, v in BOUC_WEN.items() if k != "kind"}, rel=1e-3)
    assert rig.left["alone"]["all"] < 0.1 and not rig.memory_is_seen()
    widths = (4.0 * np.arange(1, 11)).tolist()
    rig = family({"kind": "plays", "gain": 0.1, "weights": [0.01] * 10, "widths": widths, "reach": 40.0})
    assert rig.memory_is_seen() and rig.left["with_plays"]["all"] < 0.1 and rig.left["knee"] == 0


def test_a_drive_that_was_run_before_gives_the_same_readings_when_it_is_proposed(tmp_path):
    case = cases.draw("loops", 3)
    record = case["records"][0]
    t = np.arange(record.samples) / record.rate
    rows = [f"{a:.9g},{b:.9g}" for a, b in zip(t, record.drives["x"], strict=True)]
    (tmp_path / "drive.csv").write_text("\n".join(["time [s],u_x [V]", *rows]))
    again = follow.proposed(case, tmp_path / "drive.csv")
    assert again.rate == record.rate
    difference = follow.play(case, again)["x"] - case["clean"][0]["x"]
    assert np.sqrt(np.mean(difference**2)) == pytest.approx(case["floor"], rel=0.1)


def test_every_effect_has_a_campaign_that_excites_it():
    assert set(FORMS) == set(NEEDS) and set(cases.NAMED) == set(FORMS) - {"outside"}


def test_no_file_of_the_folder_imports_the_package():
    for path in FOLDER.glob("*.py"):
        assert not re.search(r"^\s*(from|import)\s+pzt_ident|hidden_effect", path.read_text(), re.MULTILINE), path.name


@pytest.mark.parametrize(("frequency", "least"), [(290.0, 12), (20.0, 2)])
def test_a_mode_that_samples_are_too_slow_for_has_steps_enough_in_its_period(frequency, least):
    """What rings at it begins at the kinks of the hysteresis, wherever these are between two samples."""
    drive = 50 - 50 * np.cos(np.arange(400) / 9)
    record = Record("sines", "identify", 200.0, {"x": drive})
    axes = {"x": Axis(dict(BOUC_WEN), [(frequency, 0.015, 1.0)])}
    rig = Rig({"axes": axes, "records": [record], "sensor": {"sigma": 0.003, "count": 0.0}, "noise_seed": 1})
    assert rig._fine(record, {}) == least


@pytest.mark.parametrize("form", ["constant", "jitter"])
def test_readings_are_those_of_a_simulation_in_finer_steps(form):
    rig, record = lone_rig({"delay": {"form": form, "size": 1.7e-3, "jitter": 0.1}})
    finest = rig.reading(0, record, fine=256)["x"]
    assert np.sqrt(np.mean((rig.reading(0, record)["x"] - finest) ** 2)) > 2 * SETTLED * rig.floor
    assert np.sqrt(np.mean((rig.settled_reading(0, record)["x"] - finest) ** 2)) < 2 * SETTLED * rig.floor


def test_a_motion_that_no_step_holds_is_said():
    rig, record = lone_rig({})
    rig.reading = lambda i, record, fine=1: {"x": np.full(record.samples, float(fine.bit_length() % 2))}
    with pytest.raises(Unsettled, match="record 0"):
        rig.settled_reading(0, record)


def lone_rig(found):
    """One axis without mechanics, with these effects, and a record of sines."""
    axis = Axis(BOUC_WEN | {"gain": 1.0}, [], found)
    rig = Rig({"axes": {"x": axis}, "records": [], "sensor": {"sigma": 0.003, "count": 0.0}, "noise_seed": 1})
    return rig, Record("sines", "identify", 200.0, {"x": 50 - 50 * np.cos(np.arange(400) / 9)})
