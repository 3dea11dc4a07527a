"""The command line as a child process: it waits, warm, for its arguments, and ends when what started it is gone."""

from __future__ import annotations

import json
import os
import signal
import sys
from importlib import import_module
from threading import Thread

WARM = (
    *("pzt_ident.run.identify", "pzt_ident.run.improve", "pzt_ident.engine.kernel", "pzt_ident.engine.lanes"),
    *("pzt_ident.cli.progress", "pzt_ident.cli.result_tables", "pzt_ident.cli.verdict_tables"),
    *("ruamel.yaml", "h5py"),
)


def end_with_parent() -> None:
    """End the command once nothing writes to its standard input any more: the workbench was killed."""
    while os.read(0, 4096):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


def arguments() -> list[str]:
    """The line of JSON on the standard input, byte by byte: what follows it is left. Ends where there is none."""
    line = bytearray()
    while not line.endswith(b"\n"):
        byte = os.read(0, 1)
        if not byte:
            sys.exit(0)
        line += byte
    return list(json.loads(line))


def main() -> None:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy comes
    from pzt_ident.cli.commands import main
    from pzt_ident.model.registry import blocks, optimizers

    for name in WARM:
        import_module(name)
    for words in (blocks, optimizers):
        words.usable()
    sys.argv[1:] = arguments()
    Thread(target=end_with_parent, daemon=True).start()
    main(prog_name="pzt-ident")
