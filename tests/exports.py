"""Identified models made up for the tests of their export, and a C compiler."""

import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from contracts.test_blocks import SPAN, waves
from pzt_ident.control.export import c
from pzt_ident.control.identified import Identified
from rig import candidates, model

COMPILER = shutil.which("gcc") or shutil.which("cc")
needs_compiler = pytest.mark.skipif(not COMPILER, reason="no C compiler is installed")
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsanitize=address,undefined",
          "-fno-sanitize-recover=all"]  # fmt: skip

LONG = [
    "delay amplifier_lag quadratic_gain distributed_memory bouc_wen asymmetry rate_dependence creep lumped resonance",
    "slew_limit bouc_wen saturation friction cross_coupling lumped kinematic_coupling encoder_cyclic_error",
    "amplitude_gain:running homogenized_energy thermal_relaxation creep:elements cross_coupling modal",
    "delay bouc_wen_oscillator drift",
    "periodic_disturbance.ripple bouc_wen creep",
    "history bouc_wen lumped",
    "bouc_wen lumped load_mass cross_coupling.stiffness",
]


def identified(words, seed=1, dt=1e-4, name="stage", units=("V", "um"), unmeasured=False):
    """A chain of blocks with values of its parameters drawn at random; the second axis may have no response."""
    chain = model(*words.split())
    if unmeasured:
        chain = model(*words.split(), axes=2, measured=[0])
    axes = range(len(chain.axes))
    theta = candidates(chain, SPAN, 1, seed)[0]
    ends = np.array([[drive.min(), drive.max()] for drive in (waves(seed + axis, 150) for axis in axes)])
    responses = tuple(units[1] if axis in chain.measured else None for axis in axes)
    blank = ("1",) * len(chain.entries), (None,) * len(chain.entries)
    return Identified(name, chain, theta, *blank, dt, ends, (units[0],) * len(axes), responses, (1.0,) * len(axes))


def is_tame(one):
    """Whether a last digit of the parameters does not grow to more than what a test allows."""
    moved = replace(one, theta=one.theta * (1 + 1e-14)).test_vector[1]
    response = one.test_vector[1]
    return np.all(np.abs(moved - response) < 1e-11 * np.abs(response).max())


def compiled(models, folder, precision="double", inverse=True, apart=True):
    """One program that runs the tests of all models; returns how to run it. apart: each file is compiled for itself, as
    a user would; else those of a model together, in fewer runs of the compiler."""
    sources, calls = [], []
    for one in models:
        for name, text in c.files(one, precision, inverse).items():
            text = text.replace("int main(void)", f"int {one.word}_main(void);\nint {one.word}_main(void)")
            (folder / name).write_text(text)
            sources += [name] if name.endswith(".c") else []
        if not apart:
            *sources, source, test = sources
            sources.append(f"{one.word}_both.c")
            (folder / sources[-1]).write_text(f'#include "{source}"\n#include "{test}"\n')
        calls.append(f'    printf("{one.word} "); failed += {one.word}_main();')
    declared = [f"int {one.word}_main(void);" for one in models]
    main = ["#include <stdio.h>", *declared, "int main(void)", "{", "    int failed = 0;", *calls]
    (folder / "all.c").write_text("\n".join([*main, "    return failed != 0;", "}", ""]))
    command = [COMPILER, *STRICT, *sources, "all.c", "-lm", "-o", "all"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:3000]
    return folder / "all"
