"""A lot of tiny devices, some with files that are broken, and what comes of it."""

import pytest

from experiments.fleet.lot import BROKEN, write_lot
from pzt_ident.job.schema import load_job
from pzt_ident.lot.identify import fleet
from pzt_ident.run.place import Local

DEVICES = 16


@pytest.fixture(scope="session")
def lot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lot")
    share = len(BROKEN) / DEVICES
    write_lot(folder, DEVICES, 1, broken=share, outliers=1 / DEVICES, samples=300, swarm=(12, 15))
    return folder


@pytest.fixture(scope="session")
def identified(lot, tmp_path_factory):
    """The folder of the fleet, and the events on the way."""
    events = []
    out = tmp_path_factory.mktemp("fleet") / "out"
    fleet(load_job(lot / "job.yaml"), [str(lot / "lot.csv")], out, place=Local(2), listen=events.append)
    return out, events
