"""What is said of a cluster when it is joined."""

from importlib.util import find_spec

import pytest

from pzt_ident.run.cluster_members import joined

distributed = pytest.importorskip("distributed")


@pytest.mark.parametrize("shown", [True, False])
def test_a_dashboard_is_named_where_there_is_one(shown):
    """With Bokeh, unless the scheduler is told to show none."""
    told = {"scheduler_kwargs": {"dashboard": shown}, "dashboard_address": ":0", "processes": False}
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, **told) as cluster:
        address = cluster.scheduler_address
        with distributed.Client(address, set_as_default=False) as client:
            event = joined(client, address)
            there = shown and find_spec("bokeh") is not None
            assert event["dashboard"] == (client.dashboard_link if there else None)
        assert ("Dask's dashboard: http" in event["said"]) == there
