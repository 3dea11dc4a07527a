"""The stages of unseen labs against closed forms and laws, and their campaigns against the package's words and jobs."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from experiments.other_labs import tally
from experiments.unseen_labs import drives, dynamics, hysteresis, sensor, writing
from experiments.unseen_labs.campaign import CAMPAIGNS, identify, simulate
from experiments.unseen_labs.names import NAMES
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks

FOLDER = Path(hysteresis.__file__).parent
OSCILLATOR = {"mass": 0.5, "damping": 12.0, "stiffness": 2.0e5}
GAIN, ALPHA, BETA, GAMMA = 0.1, 0.4, 0.05, 0.02
LIMIT = ALPHA * GAIN / (BETA + GAMMA)


def test_path_keeps_speeds_rests_and_holds():
    u = drives.path(1000, [0, 50, 20], 100, 0.2, hold=0.1).values
    assert u.size == 1 + 200 + 500 + 100 + 300 + 100 + 200
    assert (u[200], u[700], u[800], u[950]) == pytest.approx((0, 50, 50, 35))
    assert drives.nested(1000, 90, [1, 0.5], 100, 0.1, low=-10).values[[1000, -1]] == pytest.approx([90, 40])


def test_waves_have_their_heights_and_end_at_their_bias():
    u = drives.cosines(1000, [60, 30], 2, 2, 0.1).values
    assert u[:1100].max() == pytest.approx(60) and u[1100:].max() == pytest.approx(30) and u[-1] == 0
    for drive in (drives.chirp(2000, 40, 3, 20, 300, 0.5), drives.multisine(2000, 40, 3, 10, 300, 8, 0.5, 1)):
        late = drive.values[400:]
        assert np.abs(late - 40).max() == pytest.approx(3, rel=0.1) and late[-1] == 40
    assert np.ptp(drives.noise(500, -20, 60, 2, 4, 3).values) <= 80


def test_shorter_drives_are_held_and_what_is_ahead_is_not_recorded():
    ahead = drives.path(100, [0, 30], 100, 0).ahead()
    record = identify("r", drives.path(100, [0, 10], 10, 0), drives.path(100, [0, 7], 100, 0), ahead=ahead)
    assert record.count == 101 and record.drives["y"][-1] == pytest.approx(7)
    assert record.ahead["x"].size == 30


def _bouc_wen(corners, speed=1000.0, **more):
    drive = drives.path(1000, corners, speed, 0)
    return drive.values, hysteresis.bouc_wen(drive.values, 1e-3, GAIN, ALPHA, BETA, GAMMA, **more)


@pytest.mark.parametrize(
    ("more", "slope", "rising", "falling"),
    [
        ({}, 1, LIMIT, LIMIT),
        ({"phi": 0.01}, 1, ALPHA * GAIN / (BETA + GAMMA + 0.02), ALPHA * GAIN / (BETA + GAMMA - 0.02)),
        ({"lean": 0.2}, 1.2, 1.2 * LIMIT, 0.8 * LIMIT),
        ({"rate": 0.5, "onset": 1000 / 9}, 1.5, 1.5 * LIMIT, 1.5 * LIMIT),
    ],
)
def test_bouc_wen_ends_at_the_limits_of_its_branches(more, slope, rising, falling):
    u, h = _bouc_wen([0, 1000, -1000], **more)
    assert (h.max(), h.min()) == (pytest.approx(rising, rel=1e-6), pytest.approx(-falling, rel=1e-6))
    assert h[:1001] == pytest.approx(rising * -np.expm1(-ALPHA * GAIN * slope / rising * u[:1001]), abs=1e-7)


@pytest.mark.parametrize("activation", [0.0, 3.0])
def test_hysteresis_at_rest_relaxes_by_its_law(activation):
    drive = drives.path(1000, [0, 100, 100], 1000, 0, hold=1.0)
    h = hysteresis.bouc_wen(drive.values, 1e-3, GAIN, ALPHA, BETA, GAMMA, relax=2.0, activation=activation)
    start, end, shrunk = h[100], h[1100], math.exp(-2.0)
    if activation:  # tanh(a h / 2) decays exponentially
        start, end = (math.tanh(activation * value / 2) for value in (start, end))
    assert end == pytest.approx(start * shrunk, rel=5e-3)


def test_play_is_the_nearest_value_within_its_width():
    u = drives.path(100, [0, 50, -20, 35, 10], 100, 0).values
    first, second = (hysteresis.plays(u, np.array([width]), np.ones(1)) for width in (8.0, 15.0))
    for out, width in ((first, 8.0), (second, 15.0)):
        state = 0.0
        for value, found in zip(u, out, strict=True):
            state = min(max(state, value - width), value + width)
            assert found == state
    both = hysteresis.plays(u, np.array([8.0, 15.0]), np.array([0.3, 0.7]))
    assert both == pytest.approx(0.3 * first + 0.7 * second)


def test_widths_grow_with_the_logarithm_of_the_rate():
    u, widths, weights = drives.path(1000, [0, 50, -20, 35], 200, 0).values, np.array([4.0, 9.0]), np.array([1.0, 0.5])
    grown = widths * (1 + 0.06 * math.log(1 + 0.05 * 200**0.8))
    found = hysteresis.plays(u, widths, weights, 1e-3, 0.06, 0.05, 0.8)
    turns = (50, 120)  # where the rate of a sample is not that of a leg
    assert np.delete(found, turns) == pytest.approx(np.delete(hysteresis.plays(u, grown, weights), turns), abs=1e-6)


@pytest.mark.parametrize(
    "operator",
    [
        lambda u: hysteresis.free_energy(u, 0.05, 90.0, 30.0, 0.6, 70.0),
        lambda u: hysteresis.generalised_plays(u, np.array([5.0, 20.0]), np.array([0.1, 0.2]), 200.0, -0.1),
        lambda u: hysteresis.lorentzian_preisach(u, np.array([5.0, 20.0]), np.array([0.1, 0.2]), 90.0, 10.0),
    ],
)
def test_a_larger_loop_wipes_out_what_was_within_it(operator):
    nested = operator(drives.path(200, [0, 100, 30, 60, 30, 100, 0], 200, 0).values)
    plain = operator(drives.path(200, [0, 100, 0], 200, 0).values)
    assert nested[-1] == pytest.approx(plain[-1], abs=1e-9)


def test_operators_reach_their_ends():
    u = np.linspace(0, 5000, 400)
    assert hysteresis.free_energy(u, 0.05, 90.0, 30.0, 0.6, 70.0)[-1] == pytest.approx(0.05 * (5000 + 90), rel=1e-9)
    bent = hysteresis.generalised_plays(u, np.array([5.0]), np.ones(1), 200.0, -0.1)
    assert bent[-1] == pytest.approx(200 - 5, abs=1e-6)
    assert hysteresis.domain_walls(u / 20, 100.0, 0.0, 50.0, 1.0) == pytest.approx(np.tanh(u / 2000), abs=1e-9)
    loop = drives.path(200, [0, 300, 0], 300, 0).values
    pinned = hysteresis.domain_walls(loop, 100.0, 0.3, 50.0, 0.3)
    assert pinned[100] < pinned[300] < 1  # at half the peak, on the way up and down


def test_lag_answers_a_ramp_and_a_step_as_its_equation():
    t = np.arange(2000) * 1e-3
    assert dynamics.lag(t, 1e-3, 0.05) == pytest.approx(t - 0.05 * -np.expm1(-t / 0.05), abs=1e-12)
    step = np.append(0.0, np.ones(500))
    edge = 1 - 50 * -math.expm1(-0.02)
    expected = 1 - (1 - edge) * np.exp(-np.arange(500) * 1e-3 / 0.05)
    assert dynamics.lag(step, 1e-3, 0.05)[1:] == pytest.approx(expected, abs=1e-12)


def test_creep_and_filter_end_at_their_static_gains():
    step = np.append(0.0, np.full(5000, 2.0))
    assert dynamics.creep(step, 0.01, [0.2, 3.0], [0.01, 0.03])[-1] == pytest.approx(2 * 1.04, rel=1e-6)
    assert dynamics.second_order(step, 1e-3, 20, math.sqrt(2))[-1] == pytest.approx(2, rel=1e-9)
    overshoot = dynamics.second_order(step, 1e-4, 20, math.sqrt(2)).max() / 2 - 1
    assert overshoot == pytest.approx(math.exp(-math.pi), rel=1e-2)  # of a Butterworth filter


@pytest.fixture
def plain_states(monkeypatch):
    """State spaces as plain NumPy: their linear algebra takes longer to compile than to run."""
    monkeypatch.setattr(dynamics, "_states", dynamics._states.py_func)


FORCE = drives.cosines(20000, [10, 4], [40, 90], 2, 0.02).values


def test_oscillators_are_the_linear_one_where_nothing_is_beside_it(plain_states):
    linear = dynamics.lumped(FORCE, 5e-5, **OSCILLATOR)
    assert dynamics.oscillator(FORCE, 5e-5, **OSCILLATOR) == pytest.approx(linear, abs=1e-5)
    light = dynamics.chain(FORCE, 5e-5, **OSCILLATOR, second=1e-9, frequency=900.0, ratio=0.01)
    assert light == pytest.approx(linear, abs=1e-6)
    forces = {"x": FORCE, "y": 0.5 * FORCE}
    apart = dynamics.coupled(forces, 5e-5, OSCILLATOR, OSCILLATOR, of_y=0.0, of_x=0.0)
    assert apart["x"] == pytest.approx(linear, abs=1e-9) and apart["y"] == pytest.approx(0.5 * linear, abs=1e-9)


def test_coupled_masses_at_rest_hold_their_springs(plain_states):
    still, damped = {"x": np.append(0.0, np.full(4000, 3.0)), "y": np.zeros(4001)}, OSCILLATOR | {"damping": 300.0}
    ends = dynamics.coupled(still, 5e-5, damped, damped, of_y=0.2 * 2e5, of_x=-0.1 * 2e5)
    x = 3 / (1 + 0.2 * 0.1)
    assert (ends["x"][-1], ends["y"][-1]) == (pytest.approx(x, rel=1e-6), pytest.approx(-0.1 * x, rel=1e-6))


def test_stiffness_slip_and_film_hold_back_by_their_laws():
    ramp = drives.path(5000, [0, 10], 10, 0).values
    behind = OSCILLATOR["damping"] / OSCILLATOR["stiffness"] * 10  # of a ramp of 10 um/s
    slipping = dynamics.oscillator(ramp, 2e-4, **OSCILLATOR, bristle=2.0, slip=0.3)
    assert slipping[-1] == pytest.approx(10 - 0.3 - behind, abs=1e-4)
    squeezed = dynamics.oscillator(ramp, 2e-4, **OSCILLATOR, gap=40.0, film=30.0)
    film = 30 / (1 - 10 / 40) ** 3 / OSCILLATOR["stiffness"] * 10
    assert squeezed[-1] == pytest.approx(10 - behind - film, abs=1e-4)
    x = dynamics.oscillator(np.append(ramp, np.full(3000, 10.0)), 2e-4, **OSCILLATOR, cubic=2e-3)[-1]
    assert x + 2e-3 * x**3 == pytest.approx(10, abs=1e-4)


def test_amplifiers_limit_charge_and_wait():
    u = drives.path(1000, [0, 1, 0], 1, 0).values
    assert dynamics.slew(u, 1e-3, 3.0, 3.0, 0.0) == pytest.approx(u, abs=1e-12)
    limited = np.diff(dynamics.slew(u, 1e-3, 0.5, 0.2, 0.0))
    assert (limited.max(), limited.min()) == (pytest.approx(0.5e-3), pytest.approx(-0.2e-3))
    assert dynamics.charged(u, 1e-3, 0.05, 0.0) == pytest.approx(dynamics.lag(u, 1e-3, 0.05), abs=1e-5)
    t = np.arange(100) * 0.1
    assert dynamics.late(t, 0.1, 0.25) == pytest.approx(np.maximum(t - 0.25, 0))


def test_quadrature_errs_by_its_offsets_and_comes_back_each_period():
    x = np.linspace(0, 3, 600)
    assert sensor.quadrature(x, 0.3, 0.0, 0.0, 0.0, 0.0) == pytest.approx(x, abs=1e-12)
    error = sensor.quadrature(x, 0.3, 0.1, 0.05, 0.02, 0.03) - x
    assert sensor.quadrature(x + 0.3, 0.3, 0.1, 0.05, 0.02, 0.03) - x - 0.3 == pytest.approx(error, abs=1e-12)
    first = sensor.quadrature(x, 0.3, 0.0, 0.0, 0.01, 0.0) - x
    assert np.abs(first).max() == pytest.approx(0.3 / 2 / math.pi * 0.01, rel=1e-2)


def test_noise_has_its_memory_and_counts_are_nearest():
    coloured = writing.noise(100_000, 0.8, np.random.default_rng(4))
    assert coloured.std() == pytest.approx(1, rel=0.03)
    assert np.corrcoef(coloured[1:], coloured[:-1])[0, 1] == pytest.approx(0.8, abs=0.02)
    assert np.abs(writing.quantised(coloured, 0.05) - coloured).max() <= 0.025 + 1e-12


@pytest.mark.parametrize("name", ["a17", "a20", "a38"])
def test_half_the_step_changes_less_than_a_fiftieth_of_the_noise(name):
    campaign = CAMPAIGNS[name].build()
    for number in (0, len(campaign.records) - 1):
        coarse, fine = (simulate(campaign, number, finer)["x"] for finer in (1, 2))
        assert math.sqrt(np.mean((coarse - fine) ** 2)) < campaign.noise / 50


def test_campaigns_are_declared_in_words_of_the_catalogue():
    words, kinds = set(blocks.effects()) - set(blocks.faults()), {"single": 1, "pair": 2, "none": 0, "outside": 0}
    assert NAMES == [f"a{number:02d}" for number in range(1, 53)] == sorted(writing.SIZES)
    for name in NAMES:
        declared = CAMPAIGNS[name]
        assert len(declared.effects) == kinds[declared.kind] and len(declared.what) > 20
        assert set(declared.effects) | {other for names in declared.also.values() for other in names} <= words
    assert {effect for declared in CAMPAIGNS.values() for effect in declared.effects} == words


@pytest.mark.parametrize("name", NAMES)
def test_jobs_are_accepted_and_show_nothing_of_the_truth(tmp_path, name):
    declared = CAMPAIGNS[name]
    campaign, path = declared.build(), tmp_path / "job.yaml"
    text = writing.job(name, campaign)
    path.write_text(text)
    assert load_job(path).name == name
    assert not any(effect in text for effect in declared.effects) and declared.what not in text
    assert {record.use for record in campaign.records} == {"identify", "validate"}


def test_a_case_is_its_rig_and_its_truth(tmp_path):
    home = writing.write("a37", tmp_path)
    truth = json.loads((home / "truth.json").read_text())
    assert truth["also_right"] == {"kinematic_coupling": ["cross_coupling"], "drift": []}
    assert truth["floors"] == 21.93 and truth["records"] == len(list((home / "rig").iterdir())) - 1
    table = np.loadtxt(home / "rig" / "y_only.txt", delimiter=",")
    assert table.shape[1] == 4 and table[:, 1].max() == 0 and table[:, 3].max() == pytest.approx(130, abs=0.5)


def test_reference_rows_are_those_of_its_table():
    folder = FOLDER.parents[1] / "results" / "reference" / "unseen_labs"
    rows = json.loads((folder / "rows.json").read_text())
    assert tuple(row["name"] for row in rows) == tuple(NAMES)
    assert tally.markdown(rows) == (folder / "table.md").read_text()


def test_simulator_imports_neither_the_package_nor_another_simulator():
    for path in FOLDER.glob("*.py"):
        for line in path.read_text().splitlines():
            if line.startswith(("import", "from")):
                shared = line.startswith(
                    ("from experiments.other_labs.declared", "from experiments.other_labs.commands")
                )
                assert "pzt_ident" not in line and ("experiments" not in line or shared)
