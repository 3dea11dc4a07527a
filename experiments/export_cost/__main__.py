"""What a step of an exported model costs: ns, and instructions where valgrind is installed."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from pzt_ident.control.export import export
from pzt_ident.run.identified import read_identified

LOOP = """
#include "{word}.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
static {word}_state state;
int main(int count, char **words)
{{
    const long steps = count > 1 ? atol(words[1]) : 0;
    {word}_real drive[{upper}_DRIVES] = {{0}}, found[{upper}_RESPONSES], sum = 0;
    {word}_init(&state, {upper}_DT, 0);
    const clock_t start = clock();
    for (long i = 0; i < steps; i++) {{
        for (int k = 0; k < {upper}_DRIVES; k++) {{
            drive[k] = ({word}_real)(labs(i % 2000 - 1000) * {most});
        }}
        {word}_step(&state, drive, found);
        sum += found[0];
    }}
    printf("%.1f %g\\n", 1e9 * (double)(clock() - start) / CLOCKS_PER_SEC / (double)steps, (double)sum);
    return 0;
}}
"""


def measure(result: Path, precision: str) -> tuple[float, float | None]:
    """ns and instructions a step, of the model in a result."""
    one = read_identified(result)
    with TemporaryDirectory() as scratch:
        folder = Path(scratch)
        export(one, folder, "c", precision)
        most = max(abs(end) for ends in one.ends for end in ends) / 1000
        (folder / "loop.c").write_text(LOOP.format(word=one.word, upper=one.word.upper(), most=repr(most)))
        command = ["cc", "-O2", "-std=c99", f"{one.word}.c", "loop.c", "-lm", "-o", "loop"]
        subprocess.run(command, cwd=folder, check=True)
        times = [run(folder, ["./loop", "300000"]).stdout for _ in range(5)]
        return min(float(text.split()[0]) for text in times), instructions(folder)


def instructions(folder: Path) -> float | None:
    if not shutil.which("valgrind"):
        return None
    counts = []
    for steps in ("1000", "11000"):
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "./loop", steps]
        said = run(folder, command)
        found = re.search(r"Collected : (\d+)", said.stderr)
        counts.append(int(found[1]) if found else 0)
    return (counts[1] - counts[0]) / 10000


def run(folder: Path, command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)


def main() -> None:
    for result in map(Path, sys.argv[1:]):
        for precision in ("double", "float"):
            time, count = measure(result, precision)
            print(f"{result.name}, {precision}: {time:.0f} ns a step, {count or float('nan'):.0f} instructions")


if __name__ == "__main__":
    main()
