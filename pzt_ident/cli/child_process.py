"""The command line as a child process, which ends when the process that started it is gone."""

from __future__ import annotations

import os
import signal
from threading import Thread


def end_with_parent() -> None:
    """End the command once nothing writes to its standard input any more: the workbench was killed."""
    os.read(0, 1)
    os.kill(os.getpid(), signal.SIGTERM)


def main() -> None:
    from pzt_ident.cli.commands import main

    Thread(target=end_with_parent, daemon=True).start()
    main(prog_name="pzt-ident")
