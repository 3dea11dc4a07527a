import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

from cut_texts import cut_texts
from pzt_ident.report import figures
from pzt_ident.report.figures import draw_figure, drawn, plates, render, write_all_figures, write_page_figures
from pzt_ident.report.residual_figures import branches, cell_means, quantile_band
from pzt_ident.report.search_figures import convergence, within
from pzt_ident.report.style import COLUMN, PAGE
from pzt_ident.run.place import Local
from pzt_ident.run.results import Trace, read_results


def test_branches_follow_a_noisy_triangle():
    time = np.linspace(0, 4, 801)
    drive = 100 * np.abs((time + 1) % 2 - 1)
    noisy = drive + 0.2 * np.random.default_rng(1).uniform(-1, 1, drive.size)
    rising = np.gradient(drive) > 0
    turning = (drive < 2) | (drive > 98)
    np.testing.assert_array_equal((branches(noisy) == 1)[~turning], rising[~turning])


def test_band_of_a_known_residual():
    drive = np.repeat(np.arange(40.0), 101)
    drive_mid, low, middle, high = quantile_band(drive, np.tile(np.linspace(-1, 1, 101), 40))
    np.testing.assert_allclose(low, -0.9)
    np.testing.assert_allclose(middle, 0, atol=1e-12)
    np.testing.assert_allclose(high, 0.9)
    assert (np.diff(drive_mid) > 0).all()


def test_cells_hold_the_mean_residual_at_their_place():
    drive, response = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 1, 96), np.linspace(0, 2, 64)))
    trace = Trace("r", "identify", "x", np.arange(drive.size), drive, response, response, 3 * drive, "V", "um")
    means, extent = cell_means(trace)
    assert means.shape == (64, 96)
    np.testing.assert_allclose(means[10], 3 * np.linspace(0, 1, 96), atol=0.05)
    assert extent == (0, 1, 0, 2)


def test_descent_of_two_repeats_one_of_which_stops_early():
    rows = np.array([(0, 10, 4), (0, 20, 2), (0, 30, 1), (1, 10, 8), (1, 20, 6)], dtype=float)
    history = dict(zip(("repeat", "evaluations", "best"), rows.T, strict=True))
    spent, low, middle, high = convergence(history, "evaluations")
    np.testing.assert_allclose(spent, [10, 20, 30])
    np.testing.assert_allclose(low, [5, 3, 2.25])
    np.testing.assert_allclose(middle, [6, 4, 3.5])
    np.testing.assert_allclose(high, [7, 5, 4.75])


def test_descent_leaves_out_what_no_repeat_could_simulate():
    history = {"repeat": np.zeros(2), "evaluations": np.array([1.0, 2]), "best": np.array([np.inf, 3])}
    spent, _, middle, _ = convergence(history, "evaluations")
    assert (spent.tolist(), middle.tolist()) == ([2.0], [3.0])


@pytest.mark.parametrize(("value", "place"), [(0.0, 0.0), (5.0, 0.5), (10.0, 1.0)])
def test_place_within_linear_bounds(value, place):
    assert within({"value": value, "lower": 0.0, "upper": 10.0}) == place


def test_place_within_wide_bounds_is_logarithmic():
    assert within({"value": 1.0, "lower": 0.01, "upper": 100.0}) == pytest.approx(0.5)


@pytest.fixture(scope="module")
def written(weird):
    return {plate.name: svg for plate, svg in write_page_figures(read_results(weird), weird / "figures")}


def test_every_figure_of_the_page_is_a_file_of_valid_svg_at_its_width(weird, written):
    assert list(written) == [plate.name for plate in plates(read_results(weird)) if plate.section]
    for name, svg in written.items():
        assert (weird / "figures" / f"{name}-180mm.svg").read_bytes() == svg
        root = ElementTree.fromstring(svg)
        assert float(root.attrib["width"].removesuffix("pt")) == pytest.approx(PAGE / 25.4 * 72, rel=1e-4)
    assert not [path for path in (weird / "figures").iterdir() if path.name.startswith(".")]


def test_axes_carry_units_and_names_are_shown_as_they_are(weird):
    svg = render(plates(read_results(weird))[0], PAGE, ("svg",))["svg"]
    texts = [element.text for element in ElementTree.fromstring(svg).iter() if element.text]
    assert {"response [µm]", "residual [µm]", "time [s]"} <= set(texts)
    assert "<script>alert('x')</script> 100%_µ & \"q\" $a_1$.csv (identification)" in texts


def test_paper_files_are_pdf_and_svg_at_both_widths(plain):
    draw_figure(print, plain, 0)
    for width, points in ((COLUMN, b"249.4"), (PAGE, b"510.2")):
        pdf = next((plain / "figures").glob(f"time-1-*-{width}mm.pdf")).read_bytes()
        assert pdf.startswith(b"%PDF") and b"/MediaBox [ 0 0 " + points in pdf
    assert ElementTree.fromstring(next((plain / "figures").glob("time-1-*-88mm.svg")).read_bytes()) is not None


def test_the_same_results_give_the_same_file(plain):
    plate = plates(read_results(plain))[-1]
    assert render(plate, COLUMN, ("svg",)) == render(plate, COLUMN, ("svg",))


def test_small_numbers_put_a_power_of_ten_to_the_unit(plain):
    from dataclasses import replace
    from functools import partial

    from pzt_ident.report.signal_figures import draw_time

    trace = read_results(plain).traces[0]
    kinds = ("response", "model", "residual")
    metres = replace(trace, unit="m", **{kind: 1e-6 * getattr(trace, kind) for kind in kinds})
    plate = replace(plates(read_results(plain))[0], draw=partial(draw_time, trace=metres, noise=None, bins=200))
    assert "response [10⁻⁶ m]" in render(plate, COLUMN, ("svg",))["svg"].decode()


@pytest.mark.parametrize("width", [COLUMN, PAGE])
@pytest.mark.parametrize("folder", ["plain", "weird"])
def test_no_text_is_cut(folder, width, request):
    for plate in plates(read_results(request.getfixturevalue(folder))):
        assert not cut_texts(drawn(plate, width)), plate.name


@pytest.mark.parametrize("width", [COLUMN, PAGE])
@pytest.mark.parametrize("letters", [1, 30, 300])
def test_no_name_and_no_bounds_are_too_long(plain, letters, width):
    results = read_results(plain)
    for run in (results.best, *results.result["runs"]):
        entries = run["parameters"].values()
        run["parameters"] = {f"{number}_{letters * 'W'}": entry for number, entry in enumerate(entries)}
        for entry in entries:
            entry.update(unit=letters * "m", lower=-0.2308)
    (plate,) = (plate for plate in plates(results) if plate.name == "estimates")
    assert not cut_texts(drawn(plate, width))


def test_all_figures_of_several_results_are_drawn_side_by_side_and_told(plain, weird, monkeypatch):
    """Each in four files; the first ones of each stand for all."""
    events, every = [], figures.plates
    monkeypatch.setattr(figures, "plates", lambda results: every(results)[:4])
    write_all_figures([plain, weird], Local(2), events.append)
    for folder in (plain, weird):
        names = {plate.name for plate in figures.plates(read_results(folder))}
        files = {path.name for path in (folder / "figures").iterdir()}
        assert files >= {f"{name}-{w}mm.{form}" for name in names for w in (88, 180) for form in ("svg", "pdf")}
    assert [event["done"] for event in events] == list(range(1, events[0]["of"] + 1))


def test_matplotlib_writes_no_help_while_it_is_imported_for_figures_but_later():
    code = """if True:
        from pzt_ident.report.style import style
        with style():
            from matplotlib.artist import Artist
            from matplotlib.lines import Line2D

        class Own(Artist):
            def set_own(self, own):
                "Set it."

        line = Line2D([], [])
        line.set(color="red", linewidth=2)
        print(Line2D.set.__doc__, "own" in Own.set.__doc__, line.get_color(), line.get_linewidth())
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("None True red 2.0\n", "")
