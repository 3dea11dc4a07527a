"""The atlas of effects beside a session."""

from __future__ import annotations

import tempfile
from pathlib import Path

from pzt_ident.atlas.href import PAGE
from pzt_ident.errors import RunError
from pzt_ident.model.registry import blocks
from pzt_ident.workbench.runner import Aside
from pzt_ident.workbench.session import Session


class Atlas(Aside):
    """Drawn by a process of its own when it is first asked for, and again once a job brought other words; kept in
    memory."""

    def __init__(self, session: Session) -> None:
        super().__init__(session.root, lambda: None)
        self.session, self.words, self.html = session, list[str](), ""

    def page(self) -> str:
        """The page, nothing while it is being drawn. Raises RunError where that failed."""
        words = blocks.words()
        if words != self.words and not self.running:
            self.words, self.html = words, ""
            self.start(self._drawn())
        if self.failure:
            raise RunError(self.failure)
        return self.html

    async def _drawn(self) -> None:
        session = self.session
        job = ["--plugins", str(session.step() / "job.yaml")] if session.plugins and session.at else []
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / PAGE
            await self.run("atlas", ["atlas", "-o", str(path), *job])
            self.html = path.read_text(encoding="utf-8")
