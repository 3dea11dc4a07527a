"""The exported MATLAB function is the stage in real time, as Octave runs it."""

import shutil
import subprocess

import numpy as np
import pytest

from contracts.test_blocks import FORMS, HOSTS
from exports import LONG, identified
from pzt_ident.control.export import matlab

CHAINS = ["bouc_wen lumped", *FORMS[::4], *map(" ".join, HOSTS[::4]), *LONG]


@pytest.mark.skipif(not shutil.which("octave"), reason="no Octave is installed")
def test_function_responds_as_here(tmp_path):
    """From rest, and on from the state in which it ended."""
    models = [identified(words, name=f"m{i}") for i, words in enumerate(CHAINS)]
    script = ["failed = {};"]
    for one in models:
        for name, text in matlab.files(one).items():
            (tmp_path / name).write_text(text)
        drive, response = one.test_vector
        np.savetxt(tmp_path / f"{one.word}.drive", drive.T[:120], "%.17g")
        np.savetxt(tmp_path / f"{one.word}.response", response.T[:120], "%.17g")
        script += [
            f"u = load('{one.word}.drive'); y = load('{one.word}.response');",
            f"[a, s] = {one.word}(u(1:50, :)); b = {one.word}(u(51:end, :), s);",
            f"if ~all(all(abs([a; b] - y) <= 1e-9 * max(abs(y(:))))), disp('{one.word}'), end",
        ]
    (tmp_path / "compare_models.m").write_text("\n".join(script))
    ran = subprocess.run(["octave", "-qf", "compare_models.m"], cwd=tmp_path, capture_output=True, text=True)
    assert ran.returncode == 0 and not ran.stdout, ran.stdout + ran.stderr


def test_function_says_what_it_is():
    ((name, text),) = matlab.files(identified("bouc_wen lumped", name="x axis")).items()
    assert name == "x_axis.m"
    assert text.startswith("function [displacement, s] = x_axis(drive, s)\n    % x axis: an identified piezo stage")
    assert "% bouc_wen: y = d u - h" in text
    assert max(map(len, text.splitlines())) <= 120
