"""Run `pzt-ident improve` on a case as a user does: a process of its own with a time limit, its CPU counted."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

COMMAND = Path(sys.executable).parent / "pzt-ident"
KEPT = ("improvement.json", "improved.yaml", "next_experiment.csv")


def _wait(process, limit):
    """(exit code, CPU seconds of the process and of all that it has waited for); the group is ended at the limit."""
    ends = time.monotonic() + limit
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime
        if time.monotonic() > ends:
            os.killpg(process.pid, signal.SIGTERM)
            time.sleep(2)
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if not pid:
                os.killpg(process.pid, signal.SIGKILL)
                _, status, usage = os.wait4(process.pid, 0)
            return "time", usage.ru_utime + usage.ru_stime
        time.sleep(0.2)


def solve(home, limit, on="", budget=""):
    """Answer of the tool on the case in `home`; it is given home/rig only. A case that has one is skipped. on: the
    place where the tool works, if not here; what it does there is not counted as its CPU. budget: the tool's own, or as
    `--budget` has it."""
    home = Path(home)
    done = home / "solved.json"
    if done.exists():
        return json.loads(done.read_text())
    answer = home / "answer"
    shutil.rmtree(answer, ignore_errors=True)
    command = [COMMAND, "improve", (home / "rig" / "job.yaml").resolve(), "--out", answer.resolve()]
    command += ["--no-report", "--quiet", *(["--on", on] if on else []), *(["--budget", budget] if budget else [])]
    started = time.monotonic()
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with open(home / "said.txt", "w") as said:
        process = subprocess.Popen(
            list(map(str, command)), stdout=said, stderr=said, cwd=home / "rig", env=environment, start_new_session=True
        )
        code, cpu = _wait(process, limit)
    out = {"exit": code, "cpu": round(cpu, 1), "seconds": round(time.monotonic() - started, 1), "improvement": None}
    found = answer / "improvement.json"
    if found.exists():
        out["improvement"] = json.loads(found.read_text())
    for path in answer.glob("*") if answer.exists() else ():
        if path.name not in KEPT:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    done.write_text(json.dumps(out, indent=1))
    return out
