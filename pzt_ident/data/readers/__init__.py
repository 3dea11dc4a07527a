"""Readers of measurement files, one file a format; `read_records` is what the rest uses."""

from pzt_ident.data.readers.read import read_records

__all__ = ["read_records"]
