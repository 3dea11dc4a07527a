"""Drift: from zero to its size, whatever the drive."""

import numpy as np

from pzt_ident.effects.drift import Drift
from pzt_ident.engine.simulator import Simulator
from rig import model, record


def test_approaches_one_with_its_time_constant():
    found = [Drift.basis(t, 50.0) for t in (0, 50, 50 * np.log(2), 1e5)]
    np.testing.assert_allclose(found, [[0], [1 - np.exp(-1)], [0.5], [1]], rtol=1e-15)


def test_is_a_ramp_where_the_time_constant_is_long():
    t = np.linspace(0, 1, 50)
    np.testing.assert_allclose([3000 * Drift.basis(each, 3000.0)[0] for each in t], t, rtol=2e-4)


def test_a_grating_reads_the_stage_that_drifts():
    pitch, error, size, tau, dt = 1.0, 0.05, 3.0, 2.0, 0.01
    rig = Simulator(model("drift.read", "encoder_cyclic_error"), record(np.full(500, 0.5), dt=dt))
    names = [entry.name for entry in rig.model.entries]
    values = {"encoder_cyclic_error.sine": error, "encoder_cyclic_error.pitch": pitch, "drift.tau": tau}
    found = rig.simulate(np.array([[*(values.get(name, 0.0) for name in names), size]]))[0, 0]
    there = 0.5 + size * (1 - np.exp(-dt * np.arange(500) / tau))
    np.testing.assert_allclose(found, there + error * np.sin(2 * np.pi * there / pitch), atol=1e-12)
