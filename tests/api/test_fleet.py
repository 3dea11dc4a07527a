"""A fleet as an object."""

import subprocess
import sys

import numpy as np
import pytest

import pzt_ident as pzt
from experiments.fleet.lot import write_lot


@pytest.fixture(scope="module")
def lot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lot")
    write_lot(folder, 3, 1, broken=0.3, samples=300, swarm=(8, 8))
    return pzt.fleet(folder / "job.yaml", f"{folder}/lot/*/", folder / "out", on="local:1")


def test_it_has_the_table_the_broken_and_the_fit_of_a_device(lot):
    assert list(lot.devices["state"]).count("done") == 2
    (reason,) = lot.broken.values()
    assert "the file is empty" in reason
    row = lot.devices[lot.devices["state"] == "done"].iloc[0]
    fit = lot.fit(row["device"])
    gain = fit.parameters["bouc_wen.gain"]
    assert gain.value == row["bouc_wen.gain [um/V]"]
    assert gain.value - 1.96 * gain.stderr == pytest.approx(row["bouc_wen.gain low [um/V]"])
    assert np.isfinite(fit.simulate(1000.0, np.zeros(10))).all()
    assert str(lot).startswith("2 of 3 devices identified, 1 broken.")
    assert lot.out_of_line == {}


def test_it_draws_its_report(lot):
    assert lot.report(processes=1) == lot.folder / "report.html"
    assert "could not be identified" in (lot.folder / "report.html").read_text(encoding="utf-8")


def test_it_needs_no_guard_in_a_script(lot, tmp_path):
    """The processes that it starts do not run the script again."""
    place = lot.folder.parent
    call = f"pzt_ident.fleet({str(place / 'job.yaml')!r}, '{place}/lot/*/', 'out')"
    (tmp_path / "script.py").write_text(f"import pzt_ident\n\nprint('once')\nprint({call})\n")
    done = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("once\n2 of 3 devices identified, 1 broken.")
    assert "Traceback" not in done.stderr


def test_mistakes_are_told_with_a_remedy(lot, tmp_path):
    with pytest.raises(pzt.InputError, match="matches nothing"):
        pzt.fleet(lot.folder.parent / "job.yaml", "no/*/", tmp_path)
    with pytest.raises(pzt.InputError, match="3 is no path"):
        pzt.fleet(lot.folder.parent / "job.yaml", [3], tmp_path)
    with pytest.raises(pzt.InputError):
        lot.fit("nobody")
