"""The noise floor of a case, and the axes that its effects act on."""

from dataclasses import replace

import numpy as np
import pytest

import rig
import stage
from pzt_ident.diagnosis import refit
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.caveats import measured_only_sentence
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.block import Addition, Coupling
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks


def test_the_floor_is_the_noise(plain):
    assert plain.floor == pytest.approx(stage.NOISE, rel=0.1)


COUPLED = ("bouc_wen", "lumped", "kinematic_coupling")


MECHANICS = {name: value for name, value in stage.STAGE.items() if name.startswith("lumped")}


def seen_through_a_coupling(response=None):
    """x and y are driven, only x is measured."""
    rng = np.random.default_rng(3)
    drive = [np.interp(np.arange(600), np.arange(0, 601, 25), rng.uniform(0, 100, 25)) for _ in "xy"]
    record = rig.record(
        *drive, response=[drive[0] * 1e-7 if response is None else response, 0 * drive[1]], measured=[0]
    )
    return Case(COUPLED, (), [replace(record, response_units=("um", None))], stage.specs(MECHANICS))


ON_AXES = [word for word in blocks.effects() if not issubclass(blocks[word], Coupling | Addition)]


@pytest.mark.parametrize("effect", ON_AXES)
def test_an_effect_kept_off_an_axis_leaves_it_as_it_is_without(effect):
    """x reads what it would of a stage whose y, measured as well, has the effect at its null."""
    case = seen_through_a_coupling()
    nulls = case.unmeasured_nulls((effect,))
    assert nulls
    chain = blocks.chain((*COUPLED, effect))
    one, both = Chain(chain, "xy", (0,), given=nulls), Chain(chain, "xy", (0, 1))
    known = dict(zip(one.names, rig.candidates(one, case.records[0].drive, 4, 1).T, strict=True)) | nulls
    apart = {name: known.get(name, known.get(name.partition(".")[2])) for name in both.names}
    responses = [
        simulate(model, case.records[0], np.stack([np.broadcast_to(values[name], 4) for name in model.names], axis=1))
        for model, values in ((one, known), (both, apart))
    ]
    rig.assert_close(responses[0][:, 0], responses[1][:, 0])


def test_what_keeps_an_effect_off_is_its_null_on_the_axes_without_a_response():
    """Where nothing couples them there is nothing to keep off, and what the job has or says of is left to it."""
    case = seen_through_a_coupling()
    assert case.unmeasured_nulls(("amplifier_lag",)) == {"y.amplifier_lag.tau": 0.0}
    assert case.unmeasured_nulls(()) == {}
    assert Case(COUPLED, ("amplifier_lag",), case.records, case.specs).unmeasured_nulls(("amplifier_lag",)) == {}
    specified = case.specs | stage.specs({"amplifier_lag.tau": 1.0})
    assert Case(COUPLED, (), case.records, specified).unmeasured_nulls(("amplifier_lag",)) == {}
    assert Case(("bouc_wen", "lumped"), (), case.records, case.specs).unmeasured_nulls(("amplifier_lag",)) == {}


@pytest.mark.parametrize("measured_only", [True, False])
def test_an_axis_without_response_has_an_effect_where_that_fits_better(measured_only):
    blank, effects = seen_through_a_coupling(), ("amplifier_lag",)
    stage_of = blank.problem(effects, measured_only=measured_only)
    known = stage.STAGE | {"kinematic_coupling.ratio": 0.3, "amplifier_lag.tau": 3e-3, "y.amplifier_lag.tau": 0.0}
    theta = np.array([[known[name] for name in stage_of.model.names]])
    noise = np.random.default_rng(4).normal(0, stage.NOISE, 600)
    case = seen_through_a_coupling(simulate(stage_of.model, blank.records[0], theta)[0, 0] + noise)
    refitted = refit.refit(case, first_fit(case, 0), effects, {"amplifier_lag.tau": 1.0})
    assert refitted.measured_only == measured_only
    assert refitted.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert refitted.values["amplifier_lag.tau"] == pytest.approx(3e-3, rel=0.02)
    assert ("`y.amplifier_lag.tau: {value: 0}`" in measured_only_sentence(case, refitted)) == measured_only
