"""Equations of docstrings as MathML."""

import re

import pytest

from pzt_ident.atlas.mathml import lead_and_equation, marked_up, symbol


def plain(html):
    """What is read, pieces of one equation in one."""
    return re.sub(r"<[^>]+>", "", re.sub("</math><wbr><math>", "", html)).replace("&#x2061;", "")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("tau dx/dt + x = ratio (u - u(0))", "τdxdt+x=ratio(u−u(0))"),
        ("dh/dt <- dh/dt - |du/dt| h", "dhdt←dhdt−|dudt|h"),
        ("y = sum_i w_i F_i[u], p <- max(u - r, min(u + r, p))", "y=∑iwiFi[u], p←max(u−r,min(u+r,p))"),
        ("chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|", "χ=2|2−φ−φ2−4φ|"),
        ("m x'' + b x' = k f, at rest.", "mx′′+bx′=kf, at rest."),
        ("A loop opens: y = a x, for small x.", "A loop opens: y=ax, for small x."),
    ],
)
def test_an_equation_is_read_as_it_was_written(text, shown):
    assert plain(marked_up(text, {"ratio"})) == shown


def test_a_fraction_has_a_bar_and_no_parentheses_that_it_makes_needless():
    shown = marked_up("G = 1 / (s^2 / w^2 + 1)")
    assert shown.count("<mfrac>") == 2
    assert "(" not in shown


def test_names_have_their_letters_and_indices():
    assert symbol("tau") == "<math><mi>τ</mi></math>"
    assert symbol("k12") == "<math><msub><mi>k</mi><mtext>12</mtext></msub></math>"


def test_text_stays_text_and_is_escaped():
    assert marked_up("Lag & delay, <none> of them") == "Lag &amp; delay, &lt;none&gt; of them"
    assert "<math>" not in marked_up("It is a lag of the amplifier - no more.")


def test_a_long_bracket_may_be_broken_and_each_piece_is_whole():
    shown = marked_up("y = (a + b + c + d + e) u")
    pieces = re.findall("<math>(.*?)</math>", shown)
    assert len(pieces) == 6
    for piece in pieces:
        assert piece.count("<mrow") == piece.count("</mrow>")


def test_the_lead_ends_where_the_equation_begins():
    assert lead_and_equation("Domains follow: y = f.") == ("Domains follow", lead_and_equation("y = f.")[1])
    assert lead_and_equation("No equation.") == ("No equation.", "")
