from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from cut_texts import cut_texts
from pzt_ident.report.room import fit, make_room, text_width
from pzt_ident.report.style import style

LETTERS = st.text("aWil._ µ1", min_size=2, max_size=120)


def test_a_name_that_fits_is_left_alone():
    assert fit("short", 80) == "short"


@settings(deadline=None)
@given(LETTERS, st.floats(5, 80))
def test_a_name_that_is_too_long_loses_its_middle_and_no_more_than_it_must(name, width):
    cut = fit(name, width)
    if cut != name:
        start, end = cut.split("…")
        assert name.startswith(start) and name.endswith(end) and len(start) >= len(end)
        assert text_width(cut, 7) <= width < text_width(name, 7)
        assert text_width(cut, 7) > width - text_width("WW", 7)


def test_a_width_is_that_of_the_drawn_text():
    with style():
        text = Figure(dpi=1200).text(0, 0, "bouc_wen.gamma [µm/V]", size=6)
        assert abs(text.get_window_extent().width / 1200 * 25.4 - text_width(text.get_text(), 6)) < 0.1


@settings(deadline=None, max_examples=20)
@given(st.floats(0.05, 0.4), st.floats(0.05, 0.4))
def test_labels_up_to_most_of_the_figure_find_room(left, right):
    """Shares of the width of the figure."""
    with style():
        figure = Figure(figsize=(3, 2))
        axes = figure.subplots()
        axes.set_yticks([0], [fit(100 * "i", left * 3 * 25.4, 6)])
        axes.annotate(fit(100 * "i", right * 3 * 25.4, 6), (1, 0), xycoords="axes fraction", size=6)
        axes.set_xlabel("drive [V]")
        make_room(figure)
    assert not cut_texts(figure)
    assert axes.get_position().width > 0.05
