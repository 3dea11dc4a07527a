"""The command line, ended when whoever started it is gone."""

from __future__ import annotations

import os
import signal
from threading import Thread


def obey() -> None:
    """Interrupt the command once the pipe that it reads from has no writer: the workbench was killed."""
    os.read(0, 1)
    os.kill(os.getpid(), signal.SIGTERM)


def main() -> None:
    from pzt_ident.cli.commands import main

    Thread(target=obey, daemon=True).start()
    main(prog_name="pzt-ident")
