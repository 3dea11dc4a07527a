"""Parameters have units that are read back, whatever the units of the data are."""

from types import SimpleNamespace

import pytest

from pzt_ident.data.units import dimension, factor
from pzt_ident.model.registry import blocks
from pzt_ident.search.scales import unit_of

DECLARED = sorted({item.unit for block in blocks for item in block.parameters().values()})


@pytest.mark.parametrize("declared", DECLARED)
@pytest.mark.parametrize("response", ["um", "uC/cm2", "uC_per_cm2", "uC per cm2", "m^2", "%"])
@pytest.mark.parametrize("drive", ["V", "kV/mm", "kV_per_mm"])
def test_a_unit_of_any_data_is_that_of_the_declaration(declared, response, drive):
    record = SimpleNamespace(response_units=(response,), drive_units=(drive,))
    entry = SimpleNamespace(axis=0, parameter=SimpleNamespace(unit=declared))
    found = unit_of(SimpleNamespace(measured=(0,)), entry, record)
    expected = declared
    for word, unit in (("response", response), ("first", response), ("drive", drive)):
        expected = expected.replace(word, f"({unit})")
    assert dimension(found) == dimension(expected)
    assert factor(found) == pytest.approx(factor(expected))
