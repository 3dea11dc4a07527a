"""Let the command line solve each case, two at a time; what fails is written down and the others go on."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TWO_ROUNDS = ("loops", "one_frequency")  # kinds of campaign that may end in a tie: diagnosed too
PATIENCE = 1800  # s a command


def solve(folder: Path, workers: int = 2, retry: bool = False, on: str = "") -> list[Path]:
    """Solve each of folder/cases that has no result yet; the folders of those that failed. on: the place where the
    commands let their tasks run."""
    cases = sorted(path.parent for path in (folder / "cases").glob("*/job.yaml"))
    with ThreadPoolExecutor(workers) as pool:
        done = list(pool.map(lambda case: solve_case(case, folder / "solved" / case.name, retry, on), cases))
    return [case for case, well in zip(cases, done, strict=True) if not well]


def solve_case(case: Path, out: Path, retry: bool = False, on: str = "") -> bool:
    kind = case.name.rpartition("-")[0]
    diagnosed = kind not in TWO_ROUNDS or run("diagnose", case / "job.yaml", out, retry, on)
    return run("improve", case / "job.yaml", out, retry, on) and diagnosed


def run(command: str, job: Path, out: Path, retry: bool, on: str = "") -> bool:
    """One command into out/COMMAND; whether its result is there."""
    result = out / command / {"improve": "improvement.json", "diagnose": "diagnosis.json"}[command]
    failure = out / f"{command}_failed.json"
    if result.exists() or (failure.exists() and not retry):
        return result.exists()
    out.mkdir(parents=True, exist_ok=True)
    program = Path(sys.executable).with_name("pzt-ident")
    line = [str(program), command, str(job), "--json", "--quiet", "--no-report", *(["--on", on] if on else []), "--out"]
    start = time.monotonic()
    try:
        ended = subprocess.run([*line, str(result.parent)], capture_output=True, text=True, timeout=PATIENCE)
        code, said = ended.returncode, ended.stderr
    except subprocess.TimeoutExpired:
        code, said = None, f"stopped after {PATIENCE} s"
    if result.exists():
        (out / f"{command}_seconds.json").write_text(json.dumps(time.monotonic() - start), encoding="utf-8")
        failure.unlink(missing_ok=True)
    else:
        failure.write_text(json.dumps({"exit": code, "stderr": said[-4000:]}, indent=1), encoding="utf-8")
    return result.exists()
