"""The atlas of the package's own words, kept from one drawing to the next."""

from __future__ import annotations

import sys
from hashlib import sha256
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

from pzt_ident.files import cache_folder, write_text
from pzt_ident.model.registry import blocks, optimizers

LIBRARIES = ("numba", "numpy", "scipy")


def kept() -> Path | None:
    """Where the page is kept, under the hash of all that it is drawn from: the files of the package, Python and the
    libraries that compute. None where there are words from elsewhere."""
    if any(not item.__module__.startswith("pzt_ident.") for registry in (blocks, optimizers) for item in registry):
        return None
    package, digest = Path(str(files("pzt_ident"))), sha256(repr((sys.version, *map(version, LIBRARIES))).encode())
    for path in sorted(path for path in package.rglob("*") if path.is_file() and path.suffix != ".pyc"):
        digest.update(path.relative_to(package).as_posix().encode() + path.read_bytes())
    return cache_folder() / f"atlas_{digest.hexdigest()[:16]}.html"


def keep(page: str, path: Path) -> None:
    """In the place of those kept before."""
    for old in path.parent.glob("atlas_*.html"):
        old.unlink(missing_ok=True)
    write_text(path, page)
