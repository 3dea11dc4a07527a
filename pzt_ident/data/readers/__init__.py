"""From the channels that a job names to records; other folders use `read_records`.

In: sources, axes and the readers of `pzt_ident.data.formats`. Out: records on uniform time grids, in SI units.
"""

from pzt_ident.data.readers.read import read_records

__all__ = ["read_records"]
