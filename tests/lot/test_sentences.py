"""What is said of a lot reads as plain English, whatever the counts, and counts those that are spoken of."""

import re
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from pzt_ident.lot.sentences import findings, lead, unfinished
from pzt_ident.lot.statistics import Quantity, Trend

COUNTS = (0, 1, 2, 30)


def made_lot(*, given=0, more=0, ill=0, odd=0, broken=0, waiting=0, **known):
    """A lot of so many devices of each kind. known: what else is known of it."""
    kinds = [("adequate", [])] * given + [("adequate", ["creep"])] * more
    kinds += [("above the noise", [])] * max(ill + odd - given - more, 0)
    done = [
        {"device": f"d{place}", "verdict": verdict, "effects": effects}
        for place, (verdict, effects) in enumerate(kinds)
    ]
    rest = [{"device": f"r{place}"} for place in range(broken + waiting)]
    names = [row["device"] for row in done]
    usual = {"verdicts": {}, "statement": {"improve": True}, "effects": {}, "trends": [], "quantities": []}
    usual |= {
        "missing": {},
        "faults": {},
        "group_differences": [],
        "same_data": [],
        "of_readings": list,
        "of_units": list,
    }
    return SimpleNamespace(
        rows=[*done, *rest],
        done=done,
        broken=rest[:broken],
        ill_fitted=names[:ill],
        odd=names[ill : ill + odd],
        **usual | known,
    )


def check_english(text):
    for sentence in re.split(r"(?<=\.) ", text):
        assert re.fullmatch(r"[A-Z1-9].*[a-z]\.", sentence), sentence
        assert not re.search(
            r"\b0 |\b1 (other )?devices|\b(?!1 )\d+ (other )?device\b|\b1 (other )?device are", sentence
        )
        assert not re.search(r"\d+ (other )?devices is|none|, and|more (is|are)|of 1\b", sentence), sentence


@pytest.mark.parametrize("counts", list(product(COUNTS, repeat=4)), ids=str)
def test_the_headline_is_english_whatever_the_counts(counts):
    given, more, ill, broken = counts
    for odd, waiting in product((0, 1, 2), (0, 1)):
        lot = made_lot(given=given, more=more, ill=ill, odd=odd, broken=broken, waiting=waiting)
        if lot.rows:
            for text in [lead(lot), *unfinished(lot)]:
                check_english(text)


def test_the_headline_says_what_becomes_of_the_devices():
    assert lead(made_lot(given=168, more=19, ill=1, odd=8, broken=12)) == (
        "The model is adequate for 168 of 199 devices. With effects added, it is adequate for 19 more. It fits 1 "
        "device worse than usual. 8 other devices are out of line. 12 devices could not be identified."
    )
    assert lead(made_lot(more=1, ill=0, odd=2)) == (
        "The model is not adequate for any of 2 devices. With effects added, it is adequate for 1 of 2 devices. 2 "
        "devices are out of line."
    )
    assert lead(made_lot(broken=1)) == "The model could not be identified for the only device."
    assert lead(made_lot(waiting=3)) == "The model is not identified yet for any of 3 devices."


def quantity(name, values, known):
    values = np.array(values, float)
    return Quantity(name, "1", values, values, values, np.array(known, bool))


def test_what_is_not_determined_counts_the_devices_that_have_it():
    quantities = [
        quantity("drift.tau", [np.nan, np.nan, 1.0, 2.0, 3.0], [0, 0, 0, 0, 1]),
        quantity("bouc_wen.beta", [1.0] * 5, [0, 0, 0, 0, 1]),
        quantity("creep.tau", [np.nan] * 4 + [1.0], [0, 0, 0, 0, 0]),
    ]
    (said,) = findings(made_lot(given=5, quantities=quantities))
    assert said == (
        "The data do not determine drift.tau in 2 of 3 devices whose model has it, bouc_wen.beta in 4 of 5 devices and "
        "creep.tau in the only device whose model has it."
    )


@pytest.mark.parametrize(
    ("column", "said"),
    [
        ("temperature [K]", "gain grows with temperature by 2.0\u00a0% per K (rank correlation 0.90)."),
        ("c0", "gain grows with c0 by 2.0\u00a0% per unit (rank correlation 0.90)."),
        ("date [days]", "gain grows with date by 2.0\u00a0% per day (rank correlation 0.90)."),
    ],
)
def test_a_trend_is_said_by_the_heading_of_its_column(column, said):
    gain = quantity("gain", [0.5] * 5, [1] * 5)
    assert [*findings(made_lot(given=5, quantities=[gain], trends=[Trend("gain", column, 0.01, 0.5, 0.9, 0.0)]))] == [
        said
    ]


def test_each_clear_trend_is_said_however_weak_and_no_other():
    gain = quantity("gain", [0.5] * 5, [1] * 5)
    known = [Trend("gain", "c0", 0.01, 0.5, 0.9, 0.0), Trend("gain", "c1", -0.005, 0.5, -0.2, 0.04)]
    known += [Trend("gain", "c2", 0.01, 0.5, 0.9, 0.06)]
    (said,) = findings(made_lot(given=5, quantities=[gain], trends=known))
    assert said == (
        "gain grows with c0 by 2.0\u00a0% per unit (rank correlation 0.90) and falls with c1 by 1.0\u00a0% per unit "
        "(rank correlation \u22120.20)."
    )
