"""Thermal activation against quadrature, against relays stepped without a table, and the numbers of set T."""

import math

import numpy as np
import pytest
from scipy import special
from scipy.stats import norm

import smith
from pzt_ident.hysteresis import thermal_homogenized_energy as block
from rig import path, response
from twins import thermal_homogenized_energy_twin as twin

SHAPE = {name.partition(".")[2]: value for name, value in smith.T.items()}
WIDTH = SHAPE["thermal"] * smith.T_REMANENCE


def displacement(field, dt, **more):
    known = smith.T | {f"thermal_homogenized_energy.{word}": value for word, value in more.items()}
    return response(["thermal_homogenized_energy"], known, np.asarray(field, float), dt=dt)


@pytest.mark.parametrize("per_kt", [2e2, 2650.0])
@pytest.mark.parametrize("shell", [1e-3, 0.1, 1.0])
@pytest.mark.parametrize("share", [0.2, 0.6])
def test_closed_forms_are_the_integrals(per_kt, shell, share):
    """Of the Boltzmann density over the well, and over the shell behind the inflection point; shell in units of s."""
    inflection, width = (1 - share) * smith.T_REMANENCE, 1 / np.sqrt(per_kt * smith.T_ETA)
    given = (smith.T_ETA, smith.T_REMANENCE, inflection, per_kt, shell * width)
    coercive = smith.T_ETA * (smith.T_REMANENCE - inflection)
    for field in coercive * np.array([-1.6, -1.1, -1.0, -0.9, -0.5, 0.0, 0.7]):
        np.testing.assert_allclose(twin.closed_form(field, *given), twin.by_quadrature(field, *given), rtol=1e-10)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.6])
def test_what_is_tabulated_is_the_closed_form(share):
    """The energy linear over the shell: off by (0.1)^2 / 6 of Ec / (eta P_R - Ec) at most."""
    limit, inflection = SHAPE["remanence"], (1 - share) * smith.T_REMANENCE
    per_kt = 1 / (smith.T_ETA * WIDTH**2)
    for units in (-8.0, -2.0, 0.0, 1.0, 4.0, 7.0):
        further = units * SHAPE["thermal"] * limit
        field = further - share * limit
        mean, rate = twin.closed_form(field, smith.T_ETA, smith.T_REMANENCE, inflection, per_kt, 0.1 * WIDTH)
        found, keep, above = block.ThermalHomogenizedEnergy.leave(further, limit, 0.02 * limit, 1e-3, 0.01)
        assert found * 1e-3 == pytest.approx(rate, rel=0.02 / 6 * share / (1 - share) + 1e-9)
        assert keep == pytest.approx(math.exp(-0.01 * found), rel=1e-12)
        assert above == pytest.approx(smith.T_ETA * mean - field, rel=1e-10)


def test_own_elementary_functions():
    y = np.concatenate([np.linspace(-25, 60, 4001), [1e3, 1e8]])
    np.testing.assert_allclose([block.erfcx(each) for each in y], special.erfcx(y), rtol=1e-11)
    assert math.isfinite(block.erfcx(-1e6))
    p = np.linspace(0.5 / 640, 1 - 0.5 / 64, 200)
    np.testing.assert_allclose([block.quantile(each) for each in p], norm.ppf(p), atol=1e-12)
    assert block.shell(0.0) == 1
    assert block.shell(1e-5) == pytest.approx(1 - 0.5e-5, rel=1e-9)


def test_relays_without_a_table():
    """Interpolating what leaves costs 1e-4 of P_R."""
    given = ("coercive", "spread", "interaction", "dwell", "poled")
    known = {word: SHAPE[word] for word in given}
    for dt, field in ((0.02, path(0, 8000, 500, points=40)), (2.0, path(0, -9000, 4000, points=30))):
        found = displacement(field, dt) + smith.T_REMANENCE
        expected = twin.thermal(field, dt, smith.T_ETA, smith.T_REMANENCE, width=WIDTH, **known)
        np.testing.assert_allclose(found, expected, rtol=0, atol=3e-4 * smith.T_REMANENCE)


WIDTHS = [(0.01, 13.6), (0.1, 14.5), (0.279, 15.0), (1.12, 16.0), (5.58, 17.5), (27.9, 18.1)]


@pytest.mark.parametrize(("hertz", "percent"), WIDTHS)
def test_width_grows_with_the_logarithm_of_the_rate(hertz, percent):
    points = 400
    field = 4000 * (1 - np.cos(2 * np.pi * np.arange(3 * points) / points))
    last = displacement(field, 1 / (points * hertz))[-points:]
    width = abs(last[points // 4] - last[3 * points // 4]) / np.ptp(last)
    assert 100 * width == pytest.approx(percent, abs=0.15)


def creep(*holds, dt=0.02):
    """Growth from 0.1 to 100 s after the last step, in percent of the first."""
    field = np.concatenate([np.zeros(50), *(np.full(round(seconds / dt), level) for level, seconds in holds)])
    found = displacement(field, dt)
    begun = field.size - round(holds[-1][1] / dt)
    return 100 * (found[begun + 5000] - found[begun + 5]) / (found[55] - found[49])


def test_creep_is_arrested_by_a_small_step_back():
    """Linear creep would go on: +1.21 % after 5 % (Kelvin-Voigt)."""
    assert creep((8000, 100.2)) == pytest.approx(2.0, abs=0.1)
    assert abs(creep((8000, 0.5), (7600, 100.2))) < 0.15
    assert creep((8000, 0.5), (4800, 100.2)) == pytest.approx(-1.1, abs=0.1)


def test_creep_after_small_steps_hangs_on_the_interaction_fields():
    """Over eight sigma of 6120 V/m: the share of the creep that 64 and 256 of them miss."""
    known = {word: SHAPE[word] for word in ("coercive", "spread", "interaction", "dwell", "poled")}

    def grown(step, bins):
        field = np.concatenate([np.zeros(2), np.full(5, 4000.0), np.full(26, 4000.0 + step)])
        found = twin.thermal(field, 0.2, smith.T_ETA, smith.T_REMANENCE, width=WIDTH, nodes=16, bins=bins, **known)
        return found[-1] - found[7]

    off = {bins: [abs(grown(s, bins) / grown(s, 512) - 1) for s in (50, 2000)] for bins in (64, 256)}
    assert off[64][1] < 0.05 < off[64][0] < 0.4
    assert max(off[256]) < 0.015


def test_cold_domains_switch_at_their_coercive_field():
    """As kT / V falls the model comes to the one of plays, less the domains above eta P_R."""
    field = path(0, 8000, 0, 6000, 1000, points=60)
    known = {name.replace("thermal_", ""): value for name, value in smith.T.items() if "energy.thermal" not in name}
    known = {name: value for name, value in known.items() if "dwell" not in name}
    athermal = response(["homogenized_energy"], known, field)
    apart = [np.ptp(displacement(field, 1e-3, thermal=s, dwell=1e-6) - athermal) for s in (0.05, 0.005)]
    assert apart[1] < 0.03 * smith.T_REMANENCE < apart[0]


def test_at_rest_nothing_is_lost():
    """A poled material at no field only relaxes; a virgin one stays."""
    virgin = displacement(np.zeros(300), 1.0, poled=0.0)
    np.testing.assert_allclose(virgin, -smith.T_REMANENCE, rtol=0, atol=1e-9 * smith.T_REMANENCE)
    poled = displacement(np.zeros(300), 1.0)
    assert np.all(np.diff(poled) < 0) and poled[0] - poled[-1] < 0.1 * smith.T_REMANENCE


def test_bias_is_a_shift_of_the_drive():
    field = path(0, 8000, 100, points=20)
    shifted = displacement(field + 700, 0.01, bias=700.0, poled=2700.0)
    np.testing.assert_allclose(shifted, displacement(field, 0.01, poled=2000.0), rtol=0, atol=1e-3 * smith.T_REMANENCE)


def test_mirrored():
    field = path(0, 8000, -3000, 2000, points=30)
    found = displacement(field, 0.01, poled=3000.0) + displacement(-field, 0.01, poled=-3000.0)
    np.testing.assert_allclose(found, -2 * smith.T_REMANENCE, rtol=0, atol=1e-9 * smith.T_REMANENCE)


def test_half_the_time_step_gives_the_same():
    coarse, fine = path(0, 8000, 0, 5000, points=200), path(0, 8000, 0, 5000, points=800)
    error = displacement(fine, 2.5e-3)[::4] - displacement(coarse, 1e-2)
    assert np.abs(error).max() < 2e-3 * smith.T_REMANENCE
