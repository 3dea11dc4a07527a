"""Why an effect is not proven, in words."""

from made_fits import fit
from pzt_ident.diagnosis.suspect import Suspect


def test_the_limit_is_told():
    now = fit(1.0, 1.0, ["friction"])
    item = Suspect("friction", 0.99, 0.98, now, on_bounds=("friction.reach",), limit="a play")
    assert item.why_not.endswith(
        "98 % on the validation records, but friction.reach ended at a limit, where the effect is a play."
    )


def test_what_takes_up_nothing_is_told_as_nothing():
    item = Suspect("friction", -1.47, -0.2, fit(1.0, 1.0, ["friction"]))
    assert item.why_not.startswith("friction takes up 0 % of the misfit on the identification records and 0 % on")
