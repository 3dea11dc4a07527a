"""Who takes part in a cluster: its workers, of this version of the package, and the dashboard of its scheduler."""

from __future__ import annotations

import json
import platform
from typing import TYPE_CHECKING
from urllib.parse import urljoin
from urllib.request import urlopen

from pzt_ident.errors import InputError
from pzt_ident.run.folder import version_of
from pzt_ident.run.pool import Event

if TYPE_CHECKING:
    from distributed import Client

SECONDS_FOR_A_PAGE = 3.0
SECONDS_TO_JOIN = 30.0


def joined(client: Client, words: str) -> Event:
    """The event that names the workers and the dashboard. Raises InputError where there is no worker, or one without
    this version of the package."""
    if client.cluster is None:  # the jobs of a queue come when there is room for them
        try:
            client.wait_for_workers(1, timeout=SECONDS_TO_JOIN)
        except TimeoutError:
            remedy = f"start some: `dask worker {words} --nworkers auto --nthreads 1`"
            raise InputError("has no worker", where=f"--on {words}", remedy=remedy) from None
    threads = client.nthreads()
    check_versions(client, words)
    shared = " of several threads, which wait for each other: start them with --nthreads 1" * (
        max(threads.values(), default=1) > 1
    )
    workers = f"{len(threads)} worker{'s' * (len(threads) > 1)}"
    count = workers if threads else "jobs that wait for their turn"
    link = dashboard_of(client)
    named = (
        f"Dask's dashboard: {link}"
        if link
        else "no dashboard, as the scheduler runs without Bokeh or with --no-dashboard"
    )
    return {
        "event": "cluster",
        "said": f"{count}{shared} at {words}; {named}",
        "workers": len(threads),
        "dashboard": link,
    }


def dashboard_of(client: Client) -> str | None:
    """The address of Dask's dashboard; None where the scheduler has an address for one, but no plots to show."""
    link = client.dashboard_link
    try:
        with urlopen(urljoin(link, "individual-plots.json"), timeout=SECONDS_FOR_A_PAGE) as answer:
            return link if json.load(answer) else None
    except (OSError, ValueError):  # behind a proxy or a tunnel of the user's
        return link or None


def check_versions(client: Client, words: str) -> None:
    ours, remedy = version(), "install the same there: pip install 'pzt-ident[cluster]'"
    for address, theirs in client.run(version, on_error="return").items():
        if theirs != ours:
            problem = f"{theirs} there, {ours} here" if isinstance(theirs, str) else "pzt-ident is not installed there"
            raise InputError(f"worker {address}: {problem}", where=f"--on {words}", remedy=remedy)


def version() -> str:
    return f"pzt-ident {version_of('pzt-ident')} on Python {'.'.join(platform.python_version_tuple()[:2])}"
