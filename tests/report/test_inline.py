import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pzt_ident.report.inline import inline, relative

POINT = st.tuples(st.floats(-500, 500), st.floats(-500, 500))

SVG = b"""<?xml version="1.0"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="10pt" viewBox="0 0 10 10">
<metadata>http://example.com</metadata><!-- a note -->
<defs><style>*{stroke: red}</style><path id="m1" d="M 0 0 L 1.26 2.04 z"/><clipPath id="p1"/></defs>
<g id="figure_1"><use xlink:href="#m1" x="1.234567"/>
<g><text transform="rotate(-90 1 2)"/></g><text transform="rotate(-0 1 2)"
style="font-size: 6px; font-family: 'Arial', sans-serif; fill: #1a1a1a">a &lt;b&gt;</text>
<path d="M 0 0 C 1 2 3 4 5 6" clip-path="url(#p1)"/></g></svg>"""


def test_the_element_stands_alone_in_a_page():
    text = inline(SVG, "loops-x")
    assert "http" not in text and "metadata" not in text and "style>" not in text and "<!--" not in text
    assert 'id="loops-x-m1"' in text and 'href="#loops-x-m1"' in text and "url(#loops-x-p1)" in text
    assert "figure_1" not in text
    assert 'style="font-size:6px;fill:#1a1a1a"' in text
    assert "<g" not in text and "rotate(-90 1 2)" in text and "rotate(-0" not in text
    assert "a &lt;b&gt;" in text
    assert 'x="1.2"' in text
    assert "M 0 0 C 1 2 3 4 5 6" in text


@given(st.lists(POINT, min_size=2, max_size=30), st.booleans())
def test_steps_lead_to_the_same_points(points, closed):
    path = " L ".join(f"{x:.2f} {y:.2f}" for x, y in points)
    x = y = 0.0
    steps = re.findall(r"[ml](\S+) (\S+)", relative(f"M {path}" + closed * " z"))
    for (right, down), (wanted_x, wanted_y) in zip(steps, points, strict=True):
        x, y = x + float(right), y + float(down)
        assert (x, y) == pytest.approx((wanted_x, wanted_y), abs=0.06)


def test_a_second_stroke_starts_from_where_the_first_was_closed():
    assert relative("M 1 1 L 2 1 z M 5 5 L 6 5") == "m1 1 l1 0 z m4 4 l1 0"
