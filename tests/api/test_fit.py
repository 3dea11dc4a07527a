"""What a fit knows, shows, keeps and gives back."""

import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest

import pzt_ident as pzt
from pzt_ident import api
from pzt_ident.data.notation import quantity


def test_a_saved_fit_comes_back(improvement, tmp_path):
    fit = improvement.fit
    loaded = pzt.load(fit.save(tmp_path / "run"))
    assert str(loaded) == str(fit)
    for name, item in fit.parameters.items():
        assert loaded.parameters[name] == item
    np.testing.assert_array_equal(loaded.covariance, fit.covariance)
    for name, residual in fit.residuals.items():
        np.testing.assert_array_equal(loaded.residuals[name], residual)
    again = pzt.load(loaded.save(tmp_path / "again"))
    assert str(again) == str(fit)


@pytest.mark.parametrize("name", ["../loops", "50 % of 100 V", "$HOME", "Hübe"])
def test_a_record_may_have_any_name(name, part, quick, tmp_path):
    fit = quick(pzt.Record(*part, name=name))
    folder = fit.save(tmp_path / "run")
    assert [path.parent for path in tmp_path.rglob("*.csv")].count(folder / "data") == 1
    assert [*pzt.load(folder).residuals] == [name]


def test_how_a_record_is_scored_and_simulated_is_kept(part, quick, tmp_path):
    fit = quick(pzt.Record(*part, settle="50 ms", run_in=2, steps=3))
    loaded = pzt.load(fit.save(tmp_path / "run"))
    (record,) = loaded.records["identify"]
    assert (record.settle, record.run_in, record.steps) == (pytest.approx(0.05), 2, 3)
    np.testing.assert_array_equal(loaded.residuals["train"], fit.residuals["train"])


@pytest.mark.parametrize("level", [-20, "-0.02 kV", {"x": -20.0}])
def test_a_record_from_rest_is_kept_with_the_drive_of_it(level, part, quick, tmp_path):
    fit = quick(pzt.Record(*part, rest_at=level))
    loaded = pzt.load(fit.save(tmp_path / "run"))
    (record,) = loaded.records["identify"]
    assert record.rest_at == {"x": pytest.approx(-20)}
    np.testing.assert_array_equal(loaded.residuals["train"], fit.residuals["train"])


def test_a_fit_goes_to_another_process(fit):
    other = pickle.loads(pickle.dumps(fit))
    assert str(other) == str(fit)
    np.testing.assert_array_equal(other.residuals["test"], fit.residuals["test"])


def test_a_simulation_of_the_drive_leaves_the_residuals(fit, demo):
    for (t, u, y), residual in zip(demo, fit.residuals.values(), strict=True):
        error = fit.simulate(t, u) - y
        np.testing.assert_allclose(error - error.mean(), residual - residual.mean(), rtol=0, atol=1e-9)
        assert np.sqrt(np.mean(residual**2)) in [pytest.approx(rmse, rel=1e-6) for rmse in fit.rmse.values()]


def test_a_drive_may_be_in_any_form_and_unit(fit, demo):
    t, u, _ = demo[1]
    response = fit.simulate(t, u)
    rate = 1 / (t[1] - t[0])
    for other in (fit.simulate(rate, u), fit.simulate(t, {"x": u}), fit.simulate(pzt.Record(t, 1e3 * u, drive="mV"))):
        np.testing.assert_allclose(other, response, rtol=0, atol=1e-9)


def test_a_simulation_keeps_to_the_drive_at_any_rate(fit, demo):
    """The model is rate-independent, and the drive between samples a line."""
    t, u, _ = demo[1]
    fine = np.interp(np.linspace(0, t.size - 1, 3 * (t.size - 1) + 1), np.arange(t.size), u)
    np.testing.assert_allclose(fit.simulate(600, fine)[::3], fit.simulate(t, u), rtol=0, atol=1e-6)


def test_the_axes_of_a_drive_have_no_order(part, quick):
    t, u, y = part
    fit = quick(t, {"x": u, "y": u[::-1]}, {"x": y}, model=pzt.Model("bouc_wen", effects="cross_coupling"))
    np.testing.assert_array_equal(fit.simulate(t, {"y": u[::-1], "x": u}), fit.simulate(t, np.array([u, u[::-1]]).T))
    assert fit.parameters["cross_coupling.ratio"].verdict


def test_a_drive_that_has_run_in_is_the_second_of_two_periods(fit, demo):
    t, u, _ = demo[1]
    rate = 1 / (t[1] - t[0])
    steady = fit.simulate(pzt.Record(rate, u, run_in=1))
    np.testing.assert_allclose(steady, fit.simulate(rate, np.tile(u, 2))[t.size :], rtol=0, atol=1e-9)
    assert np.ptp(steady - fit.simulate(rate, u)) > 1e-3


def test_a_drive_from_rest_is_one_with_a_sample_ahead(fit, demo):
    t, u, _ = demo[1]
    rate = 1 / (t[1] - t[0])
    stepped = fit.simulate(pzt.Record(rate, u + 20, rest_at=0))
    np.testing.assert_allclose(stepped, fit.simulate(rate, np.append(0, u + 20))[1:], rtol=0, atol=1e-9)
    assert np.ptp(stepped - fit.simulate(rate, u + 20)) > 1e-3


def test_each_axis_keeps_its_own_unit(part, quick):
    """Over both axes the RMSE is the root mean square of theirs, in the unit of the first."""
    t, u, y = part
    drive, measured = np.array([u, u[::-1]]).T, np.array([y, 1e3 * y[::-1]]).T
    fit = quick(t, drive, measured, response={"x": "um", "y": "nm"})
    error, residual = fit.simulate(t, drive) - measured, fit.residuals["train"]
    np.testing.assert_allclose(error - error.mean(axis=0), residual - residual.mean(axis=0), rtol=0, atol=1e-6)
    assert fit.unit == "um"
    assert fit.rmse["identify"] == pytest.approx(np.sqrt(np.mean((residual / [1, 1e3]) ** 2)), rel=1e-6)
    x, y = (quantity(fit.noise_floor[axis], unit) for axis, unit in (("x", "um"), ("y", "nm")))
    assert f"noise floor: {x} (x) and {y} (y)" in str(fit)
    assert fit.noise_floor["y"] == pytest.approx(1e3 * fit.noise_floor["x"], rel=0.2)


def test_errors_are_the_diagonal_of_the_covariance(improvement):
    fit = improvement.fit
    assert [*fit.covariance.columns] == [*fit.covariance.index]
    np.testing.assert_allclose(fit.covariance, fit.covariance.T, rtol=1e-9)
    for name, item in fit.parameters.items():
        if item.stderr is not None:
            assert fit.covariance.loc[name, name] == pytest.approx(item.stderr**2, rel=1e-6)


def test_what_data_do_not_determine_has_no_error(quick):
    fit = quick(model=pzt.Model("bouc_wen", "lumped"))
    mass = fit.parameters["lumped.mass"]
    assert (mass.stderr, mass.verdict) == (None, "not determined")


def test_the_seed_decides(part):
    fits = [pzt.identify("bouc_wen", pzt.Record(*part), seed=seed, evaluations=60, polish=False) for seed in (1, 1, 2)]
    assert fits[0].point.tolist() == fits[1].point.tolist() != fits[2].point.tolist()


def test_of_repeats_the_best_is_taken(part):
    fit = pzt.identify("bouc_wen", pzt.Record(*part), evaluations=60, repeats=3, polish=False)
    assert fit.rmse["identify"] == min(run["rmse"]["identify"] for run, _ in fit.runs)
    assert len({run["rmse"]["identify"] for run, _ in fit.runs}) == 3


def test_one_evaluation_is_a_budget(part):
    fit = pzt.identify("bouc_wen", pzt.Record(*part), evaluations=1, polish=False)
    assert fit.best["evaluations"] == 1


@pytest.mark.parametrize("show", [str, repr, lambda fit: fit._repr_html_()])
def test_a_fit_shows_value_error_unit_and_verdict(show, improvement):
    text = show(improvement.fit)
    for part in (
        "bouc_wen.gain",
        "0.08209 ± 0.00012",
        "µm/V",
        "determined",
        "0.005033",
        "noise floor: 0.004952",
        "1.02 noise floors",
    ):
        assert part in text.replace("\N{NO-BREAK SPACE}", " ")


def test_html_is_a_table_without_markup_of_names(part, quick):
    page = quick(pzt.Record(*part, name="<b>"))._repr_html_()
    assert page.count("<tr>") == 5 and "<b>" not in page


def test_figures_name_their_axes_with_units(fit, improvement):
    labels = [[(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes] for figure in figures(fit, improvement)]
    time, loops, stairs = ([text for pair in each for text in pair] for each in labels)
    assert "[s]" in str(time) and str(time).count("[µm]") + str(time).count("[nm]") >= 2
    assert "[V]" in str(loops) and "[µm]" in str(loops)
    assert "[µm]" in str(stairs) or "[nm]" in str(stairs)


def figures(fit, improvement):
    drawn = [fit.plot("test"), fit.plot_loops(), improvement.plot()]
    assert all(figure._repr_png_().startswith(b"\x89PNG") for figure in drawn)
    return drawn


def test_a_report_is_one_page_without_warnings(improvement, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        page = improvement.fit.report(tmp_path / "new" / "report.html")
    text = page.read_text(encoding="utf-8")
    assert "quadratic_gain" in text and "test" in text
    assert [path.name for path in tmp_path.rglob("*.*")] == ["report.html"]


def test_the_package_imports_nothing_heavy():
    code = "import sys, pzt_ident; print([m for m in ('numpy', 'numba', 'matplotlib', 'pandas') if m in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"


def test_every_name_of_the_package_is_explained():
    assert pzt.__all__ == api.__all__
    for name in pzt.__all__:
        assert getattr(pzt, name).__doc__, name
    with pytest.raises(AttributeError, match="has no attribute 'identity'"):
        pzt.identity  # noqa: B018
