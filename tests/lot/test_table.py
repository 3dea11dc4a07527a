"""The folder of a device, whatever its name."""

from pathlib import Path

from hypothesis import example, given
from hypothesis import strategies as st

from pzt_ident.lot.table import folder_of

NAMES = st.text(max_size=300) | st.text(st.sampled_from("./\\%~ \0\n\x1b"), max_size=8) | st.text(min_size=200)
FLEET = Path("/fleet")


@given(NAMES, NAMES)
@example("", "%")
@example(".", "..")
@example("/", "//")
@example(".new", "%2Enew")
@example("\udcff", "\\udcff")
@example("é" * 4000, "é" * 4001)
def test_each_name_leads_to_a_folder_of_its_own_below_devices(name, other):
    home = folder_of(FLEET, name)
    assert home.parent == FLEET / "devices" and home.resolve() == home
    assert home.name.isascii() and home.name.isprintable() and not home.name.startswith(".")
    assert 0 < len(home.name) < 200 and not set('/\\:*?"<>|') & set(home.name)
    assert (home == folder_of(FLEET, other)) == (name == other)
