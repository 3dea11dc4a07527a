"""The drive that a diagnosis proposes: within which limits, and as CSV."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.notation import listed
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.next_experiment import SEPARATED, WELL_SEPARATED, DriveLimits, Proposal, propose
from pzt_ident.files import write_text
from pzt_ident.job.schema import Job
from pzt_ident.model.registry import blocks


def separating(job: Job, case: Case, rivals: dict[str, Fit], folder: Path) -> dict[str, Any] | None:
    """The drive that tells rivals apart, written as CSV; None where they are not several, or none does."""
    proposal = propose(case, rivals, reaches_of(job, case)) if len(rivals) > 1 else None
    return written(case, proposal, folder) if proposal else None


def reaches_of(job: Job, case: Case) -> list[DriveLimits]:
    """The job's limits for each axis; where it gives none, what the records themselves did."""
    limits, first = job.limits, case.records[0]
    length = limits.duration or max(60.0, *(record.samples * record.dt for record in case.records))
    reaches = []
    for axis, unit in enumerate(first.drive_units):
        size, drives = factor(str(unit)), [record.drive[axis] for record in case.records]
        low, high = limits.drive or (min(u.min() for u in drives) / size, max(u.max() for u in drives) / size)
        rates = [float(np.abs(np.diff(u)).max()) / r.dt for u, r in zip(drives, case.records, strict=True)]
        reaches.append(DriveLimits(low * size, high * size, limits.slew * size if limits.slew else max(rates), length))
    return reaches


def limits_of(job: Job, case: Case) -> str:
    """`0 to 100 V, 126 V/s, 60 s`, those of the first measured axis."""
    axis = case.records[0].measured[0]
    reach, unit = reaches_of(job, case)[axis], str(case.records[0].drive_units[axis])
    low, high, rate = (value / factor(unit) for value in (reach.low, reach.high, reach.rate))
    return f"{low:.4g} to {high:.4g} {unit}, {rate:.4g} {unit}/s and {reach.duration:.4g} s"


def written(case: Case, proposal: Proposal, folder: Path) -> dict[str, Any]:
    """The proposal and its drive as CSV."""
    first = case.records[0]
    size = [factor(str(unit)) for unit in first.drive_units]
    header = ",".join(
        ["time [s]", *(f"u_{axis} [{unit}]" for axis, unit in zip(first.axes, first.drive_units, strict=True))]
    )
    time = np.arange(proposal.drive.shape[1]) * proposal.dt
    rows = np.column_stack([time, *(row / s for row, s in zip(proposal.drive, size, strict=True))])
    text = "\n".join([header, *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n"
    path = folder / "next_experiment.csv"
    write_text(path, text)
    models = f"the models with {listed(proposal.splits)}"
    apart = f"{models} differ by {proposal.separation:.1f} noise floors"
    if proposal.separation <= SEPARATED:
        apart = f"some of {models} differ by more than {SEPARATED:g} noise floors"
    sentence = f"{proposal.name}, sampled at {1 / proposal.dt:g} Hz, on which {apart}"
    if proposal.separation < WELL_SEPARATED:
        sentence += f", which is little. {blocks[proposal.splits[0]].separate_by}".removesuffix(".")
    return {"splits": list(proposal.splits), "file": path.name, "why": sentence}
