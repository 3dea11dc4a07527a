"""Bouc-Wen against its differential equation, its closed forms and the numbers of Lin & Lin (2012)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lin_lin
from pzt_ident.hysteresis.bouc_wen import BoucWen, regime
from rig import path, response, triangle
from twins import bouc_wen_twin
from twins.plain import leg

SHAPES = {
    "beta < gamma": (0.0148, 0.0552),
    "gamma = 0": (0.1111, 0.0),
    "beta = gamma": (0.05, 0.05),
    "gamma < 0": (0.1, -0.05),
    "no forgetting along": (0.05, -0.05),
    "no forgetting": (0.0, 0.0),
}
NESTED = (0, 130, 0, 130, 60, 80, -20, 5)
quick = settings(deadline=None, max_examples=50, derandomize=True)


def displacement(drive, parameters=lin_lin.X):
    return response(["bouc_wen"], parameters, drive)


def memory(drive, parameters=lin_lin.X):
    """h in um."""
    return parameters["bouc_wen.gain"] * drive - displacement(drive, parameters)


def limits(parameters):
    """Saturation in um, slope of h after a reversal from it, and the largest slope there is, in um/V."""
    gain, alpha, beta, gamma = lin_lin.bouc_wen(parameters)
    reversal = 2 * beta / (beta + gamma)
    return alpha * gain / (beta + gamma), alpha * gain * reversal, alpha * gain * max(1, reversal)


@pytest.mark.parametrize("points", [3, 40])
@pytest.mark.parametrize("shape", SHAPES)
def test_closed_form_solves_the_differential_equation(shape, points):
    drive, shape = path(*NESTED, points=points), (0.082, 0.56, *SHAPES[shape])
    found = displacement(drive, dict(zip(lin_lin.WORDS[3:], shape, strict=True)))
    np.testing.assert_allclose(found, bouc_wen_twin.bouc_wen(drive, *shape), rtol=0, atol=1e-12)


@given(
    beta=st.floats(0, 0.3),
    share=st.floats(-1, 3),
    start=st.floats(-1, 1),
    parts=st.lists(st.floats(0.01, 50), min_size=2, max_size=6),
)
@quick
def test_a_leg_in_parts_is_the_leg_in_one(beta, share, start, parts):
    gamma, height = share * beta, 10.0
    along, against = regime(beta + gamma), regime(beta - gamma)
    in_parts = start * height
    for part in parts:
        in_parts = leg(BoucWen, in_parts, part, along, against)
    in_one = leg(BoucWen, start * height, sum(parts), along, against)
    assert 0.08 * in_parts == pytest.approx(0.08 * in_one, rel=1e-13, abs=1e-14)


@given(start=st.floats(-14, 14), parts=st.lists(st.floats(0.01, 50), min_size=2, max_size=6))
@quick
def test_a_leg_of_lin_and_lin_in_parts_is_the_leg_in_one_to_a_hundredth_of_a_picometre(start, parts):
    """In um, h = 0.082 * 0.559 q below 0.65 um."""
    along, against = regime(0.0148 + 0.0552), regime(0.0148 - 0.0552)
    in_parts = start
    for part in parts:
        in_parts = leg(BoucWen, in_parts, part, along, against)
    change = in_parts - leg(BoucWen, start, sum(parts), along, against)
    assert abs(0.082 * 0.559 * change) < 1e-14


@pytest.mark.parametrize("points", [2, 3, 7, 50, 1000])
def test_sampling_does_not_matter(points):
    found = displacement(path(*NESTED, points=points))[::points]
    np.testing.assert_allclose(found, displacement(np.array(NESTED)), rtol=0, atol=2e-13)


def test_explicit_euler_comes_slowly_to_the_closed_form():
    for points, expected in {50: 48, 500: 5, 5000: 0.5}.items():
        drive = triangle(130, cycles=2, points=points)
        gain, alpha, beta, gamma = lin_lin.bouc_wen(lin_lin.X)
        h = [0.0]
        for move in np.diff(drive):
            h.append(h[-1] + alpha * gain * move - beta * abs(move) * h[-1] - gamma * move * abs(h[-1]))
        assert 1e3 * np.abs(h - memory(drive)).max() == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("row", "volts", "peak", "width", "percent"),
    [
        (lin_lin.TABLE_3["RGA"], 130, 9.997, 1.243, 13.3),
        (lin_lin.TABLE_3["PSO"], 130, 9.999, 1.247, 13.3),
        (lin_lin.TABLE_3["CSA"], 130, 10.000, 1.246, 13.3),
        (lin_lin.TABLE_4["RGA"], 90, 9.437, 1.031, 11.6),
        (lin_lin.TABLE_4["PSO"], 90, 9.437, 1.030, 11.6),
        (lin_lin.TABLE_4["CSA"], 90, 9.435, 1.029, 11.5),
    ],
)
def test_loops_of_tables_3_and_4(row, volts, peak, width, percent):
    x = displacement(triangle(volts), row)
    opening = (x[2500:][::-1] - x[2000:2501]).max()
    assert x.max() == pytest.approx(peak, abs=6e-4)
    assert opening == pytest.approx(width, abs=6e-4)
    assert 100 * opening / (x.max() - x[3000]) == pytest.approx(percent, abs=0.06)


@pytest.mark.parametrize(("row", "volts", "residual"), [(lin_lin.X, 130, 0.654), (lin_lin.Y, 90, 0.522)])
def test_residual_displacement_at_rest(row, volts, residual):
    assert displacement(triangle(volts), row)[-1] == pytest.approx(residual, abs=6e-4)


@pytest.mark.parametrize(
    ("table", "volts", "apart"),
    [(lin_lin.TABLE_3, 130, {"RGA": 15, "CSA": 8}), (lin_lin.TABLE_4, 90, {"RGA": 0.5, "CSA": 1.3})],
)
def test_optimizers_of_the_paper_found_nearly_one_curve(table, volts, apart):
    curves = {name: displacement(triangle(volts), row) for name, row in table.items()}
    for name, expected in apart.items():
        rms = 1e3 * np.sqrt(np.mean((curves[name] - curves["PSO"]) ** 2))
        assert rms == pytest.approx(expected, rel=0.06), name


@pytest.mark.parametrize(
    ("row", "saturation", "volts"),
    [
        (lin_lin.X, 0.654, 14.3),
        (lin_lin.Y, 0.522, 9.0),
        (lin_lin.COUPLED_X, 0.649, 15.2),
        (lin_lin.COUPLED_Y, 0.325, 3.4),
    ],
)
def test_memory_saturates(row, saturation, volts):
    *_, beta, gamma = lin_lin.bouc_wen(row)
    assert 1 / (beta + gamma) == pytest.approx(volts, abs=0.06)
    assert limits(row)[0] == pytest.approx(saturation, abs=6e-4)
    assert memory(np.array([0, 2000.0, 0]), row)[1:] == pytest.approx([limits(row)[0], -limits(row)[0]], rel=1e-12)


@pytest.mark.parametrize("row", [lin_lin.X, lin_lin.Y, lin_lin.COUPLED_X, lin_lin.COUPLED_Y])
def test_slopes_have_their_limits(row):
    _, reversal, largest = limits(row)
    h = memory(np.array([0, 2000, 2000 - 1e-3]), row)
    assert (h[1] - h[2]) / 1e-3 == pytest.approx(reversal, rel=1e-3)
    drive = np.random.default_rng(1).normal(scale=30, size=50).repeat(2).cumsum()
    drive[1::2] += 0.01
    slopes = np.abs(np.diff(memory(drive, row)) / np.diff(drive))
    assert slopes.max() <= largest * (1 + 1e-9)


def test_coupled_y_moves_the_wrong_way_after_a_reversal():
    gain = lin_lin.COUPLED_Y["bouc_wen.gain"]
    y = displacement(np.concatenate([[0], 90 - np.arange(0, 20, 0.01)]), lin_lin.COUPLED_Y)[1:]
    assert (y[0] - y[1]) / 0.01 == pytest.approx(-0.73 * gain, rel=0.01)
    assert 0.01 * np.argmax(y) == pytest.approx(2, abs=0.2)
    assert np.all(np.diff(displacement(90 - np.arange(0, 20, 0.01), lin_lin.X)) < 0)


def test_nested_loops_do_not_close():
    """Bouc-Wen has no return-point memory: 60 to 80 V after 130 V creeps down, 90 to 100 V on the way up creeps up."""
    visits = displacement(path(0, 130, 60, 80, *[60, 80] * 4))[::100][3::2]
    assert 1e3 * np.diff(visits) == pytest.approx([-227, -76, -31, -13], abs=0.6)
    rising = displacement(path(0, 130, 0, 100, *[90, 100] * 6))[::100]
    assert 1e3 * (rising[-1] - rising[3]) == pytest.approx(382, abs=0.6)


def test_settled_loops_are_the_same_at_every_bias():
    loops = [displacement(path(0, *[bias + 40, bias] * 8))[-201:] for bias in (0, 20, 50)]
    for loop in loops:
        np.testing.assert_allclose(loop - loop[0], loops[0] - loops[0][0], rtol=0, atol=3e-6)


def test_rate_does_not_matter():
    drive = path(*NESTED, points=30)
    held = displacement(drive.repeat(5))
    np.testing.assert_allclose(held[::5], displacement(drive), rtol=0, atol=1e-12)
    np.testing.assert_allclose(held[4::5], held[::5], rtol=0, atol=1e-12)


def test_memory_is_odd():
    drive = path(*NESTED, points=30)
    np.testing.assert_allclose(memory(-drive), -memory(drive), rtol=0, atol=1e-13)


@pytest.mark.parametrize("offset", [-20, 1000])
def test_an_offset_of_the_drive_is_one_of_the_displacement(offset):
    drive = path(*NESTED, points=30)
    moved = displacement(drive + offset) - lin_lin.X["bouc_wen.gain"] * offset
    np.testing.assert_allclose(moved, displacement(drive), rtol=0, atol=1e-12)


@pytest.mark.parametrize("row", [lin_lin.X, lin_lin.Y])
def test_memory_stays_within_its_saturation(row):
    """Ikhouane & Rodellar (2007), Systems with Hysteresis, for beta + gamma > 0."""
    drive = np.random.default_rng(2).normal(scale=200, size=2000)
    assert np.abs(memory(drive, row)).max() <= limits(row)[0] * (1 + 1e-12)
