"""What was before a record: the hysteresis is where the reversals ahead of it led, and all else is at rest."""

import numpy as np
import pytest

import rig
from pzt_ident.engine.simulator import Simulator
from rig import model, path, record

BOUC_WEN = {"gain": 1.0, "alpha": 0.5, "beta": 0.03, "gamma": -0.01}
OPERATORS = {
    "bouc_wen": BOUC_WEN,
    "prandtl_ishlinskii": {"gain": 1.0, "reach": 30.0} | {f"weight_{i}": 0.1 for i in range(1, 9)},
    "homogenized_energy": {"gain": 1.0, "remanence": 30.0, "coercive": 10.0, "spread": 0.6, "interaction": 8.0}
    | {"quadratic": 0.0, "poled": 0.0, "bias": 0.0},
}
MECHANICS = {"lumped.mass": 0.15, "lumped.damping": 9.0, "lumped.stiffness": 5e4}
RECORD = path(30, 70, 10, 50, points=40)
LED = {"history": (80.0,), "history.two": (5.0, 90.0)}  # drives at the reversals, the last one first


def named(word):
    return {f"{word}.{name}": value for name, value in OPERATORS[word].items()}


def of_model(chain, parameters, drive, amounts=(), dt=1e-3, **more):
    """The response of one candidate with amounts of the record, (samples,)."""
    made = model(*chain)
    theta = np.array([[*(parameters[name] for name in made.names), *amounts]])
    return Simulator(made, record(drive, dt=dt, **more)).simulate(theta)[0, 0]


def amounts_of(item, start=RECORD[0]):
    return [reversal - start for reversal in LED[item]]


@pytest.mark.parametrize("steps", [1, 3])
@pytest.mark.parametrize("item", LED)
@pytest.mark.parametrize("word", OPERATORS)
def test_a_record_is_the_end_of_a_drive_from_its_last_reversals(word, item, steps):
    led = np.array([*reversed(LED[item]), *RECORD])
    expected = of_model([word], named(word), led, steps=steps)[len(LED[item]) :]
    found = of_model([item, word], named(word), RECORD, amounts_of(item), steps=steps)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("item", LED)
@pytest.mark.parametrize("word", OPERATORS)
def test_without_a_reversal_it_is_as_from_rest(word, item):
    found = of_model([item, word], named(word), RECORD, [0.0] * len(LED[item]))
    np.testing.assert_allclose(found, of_model([word], named(word), RECORD), rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("creep", {"creep.ratio": 0.2, "creep.tau": 0.02, "creep.decades": 1.0}),
        ("sensor_lag", {"sensor_lag.tau": 5e-3}),
        ("friction", {"friction.force": 2.0, "friction.stiffness": 1.0, "friction.stiction": 0.1}),
    ],
)
def test_all_behind_the_hysteresis_is_at_rest(effect, values):
    """As behind a force that is what the hysteresis makes of it, from its first sample on."""
    force = of_model(["history", "bouc_wen"], named("bouc_wen"), RECORD, amounts_of("history"))
    values = {name: value for name, value in values.items() if name in model(effect).names} | {
        entry.name: values.get(entry.name, entry.parameter.bounds[0])
        for entry in model(effect).entries
        if entry.name not in values
    }
    expected = of_model([effect], values, force)
    found = of_model(["history", "bouc_wen", effect], named("bouc_wen") | values, RECORD, amounts_of("history"))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("begun", "swing"), [(0.0, 0.0), (3.0, 0.0), (0.0, -2.0), (1.0, 1.5)])
def test_a_mass_is_under_way_as_a_record_begins(begun, swing):
    """It decays about the force: x = f + exp(-zeta w t) (A cos(w_d t) + B sin(w_d t))."""
    rested, dt, steps = np.full(400, 30.0), 1e-4, np.arange(1, 401)
    mass, damping, stiffness = MECHANICS.values()
    omega = np.sqrt(stiffness / mass)
    zeta = damping / (2 * np.sqrt(stiffness * mass))
    damped, t = omega * np.sqrt(1 - zeta**2), dt * steps
    sine = omega * (swing + zeta * begun) / damped
    free = np.exp(-zeta * omega * t) * (begun * np.cos(damped * t) + sine * np.sin(damped * t))
    found = of_model(["history", "lumped"], MECHANICS, rested, [0.0, begun, swing], dt=dt)
    np.testing.assert_allclose(found, 30 + free, rtol=0, atol=1e-9)


def test_what_a_mass_did_before_a_record_follows_from_it():
    made, drive = model("history", "bouc_wen", "lumped"), path(30, 70, 10, 50, points=150)
    known = named("bouc_wen") | MECHANICS
    theta, truth = np.array([[known[name] for name in made.names]]), [40.0, 1.5, -0.7]
    response = of_model(["history", "bouc_wen", "lumped"], known, drive, truth)
    simulator = Simulator(made, record(drive, response=[response]))
    assert simulator.squares(theta)[0, 0] < 1e-9 * np.sum((response - response.mean()) ** 2)
    np.testing.assert_allclose(simulator.amounts.complete(theta)[0, -3:], truth, atol=2e-3)


@pytest.mark.parametrize("reversal", [-40.0, 10.0, 55.0, 100.0])
def test_the_last_reversal_follows_from_a_record_with_bouc_wen(reversal):
    made = model("history", "bouc_wen")
    theta = np.array([[BOUC_WEN[name.partition(".")[2]] for name in made.names]])
    response = of_model(["bouc_wen"], named("bouc_wen"), np.array([reversal, *RECORD]))[1:]
    simulator = Simulator(made, record(RECORD, response=[response]))
    assert simulator.squares(theta)[0, 0] < 1e-9 * np.sum((response - response.mean()) ** 2)
    found = simulator.amounts.complete(theta)[0, -1]
    assert found == pytest.approx(reversal - RECORD[0], abs=1e-3)


@pytest.mark.parametrize("item", LED)
def test_a_record_in_steady_state_forgets_what_was_before(item):
    drive = rig.triangle(80, cycles=4, points=30)
    led, plain = (
        of_model(chain, named("bouc_wen"), drive, amounts, run_in=3)
        for chain, amounts in (([item, "bouc_wen"], [20.0] * len(LED[item])), (["bouc_wen"], ()))
    )
    np.testing.assert_allclose(led, plain, rtol=0, atol=1e-3)


def test_a_sample_at_a_time_nothing_is_before():
    """As for a controller, which begins at rest: the model is the one without it."""
    known = named("bouc_wen") | MECHANICS
    chains = [model(*before, "bouc_wen", "lumped") for before in ([], ["history"])]
    theta = np.array([known[name] for name in chains[0].names])
    alone, led = (rig.stage_of(chain, record(RECORD), theta) for chain in chains)
    drive = RECORD[None]
    np.testing.assert_array_equal(led.respond(drive), alone.respond(drive))
