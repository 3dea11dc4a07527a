"""The exported FMU is the stage in real time."""

import zipfile

import numpy as np
import pytest

from exports import identified, needs_compiler
from pzt_ident.control.export import fmu
from pzt_ident.control.stage import EVERYTHING, Stage

CHAINS = [
    "delay amplifier_lag bouc_wen creep lumped",
    "quadratic_gain homogenized_energy cross_coupling lumped kinematic_coupling",
    "bouc_wen_oscillator",
]


def written(one, folder):
    ((name, content),) = fmu.files(one).items()
    (folder / name).write_bytes(content)
    return folder / name


def simulated(path, one, drive, **more):
    from fmpy import simulate_fmu

    names = [f"u_{axis}" for axis in one.chain.axes]
    inputs = np.zeros(drive.shape[1], [("time", float), *((name, float) for name in names)])
    inputs["time"] = one.dt * np.arange(drive.shape[1])
    for name, signal in zip(names, drive, strict=True):
        inputs[name] = signal
    stop = inputs["time"][-1]
    outputs = [one.chain.axes[axis] for axis in one.outputs]
    found = simulate_fmu(
        path, stop_time=stop, step_size=one.dt, output_interval=one.dt, input=inputs, output=outputs, **more
    )
    return np.array([found[name] for name in outputs])


@needs_compiler
@pytest.mark.parametrize("words", CHAINS)
def test_fmu_responds_as_here_a_sample_later(words, tmp_path):
    from fmpy.validation import validate_fmu

    one = identified(words)
    drive, response = one.test_vector
    path = written(one, tmp_path)
    assert validate_fmu(str(path)) == []
    found = simulated(path, one, drive)
    size = np.abs(response).max()
    np.testing.assert_allclose(found[:, 1:], response[:, : found.shape[1] - 1], atol=1e-9 * size)
    np.testing.assert_allclose(found[:, 0], response[:, 0], atol=1e-9 * size)


@needs_compiler
def test_parameters_of_the_fmu_are_those_of_the_model(tmp_path):
    one = identified("bouc_wen lumped", units=("V", "m"))
    drive, response = one.test_vector
    at = one.chain.names.index("bouc_wen.gain")
    found = simulated(written(one, tmp_path), one, drive, start_values={"bouc_wen.gain": 2 * one.value(at)})
    theta = one.theta.copy()
    theta[at] *= 2
    stage = Stage(one.chain, theta, one.dt, [1.0], [1.0])
    expected = stage.respond(drive, EVERYTHING)
    np.testing.assert_allclose(found[:, 1:], expected[:, : found.shape[1] - 1], atol=1e-9 * np.abs(response).max())


def test_fmu_without_a_compiler_holds_its_sources(tmp_path, monkeypatch):
    monkeypatch.setattr(fmu.shutil, "which", lambda word: None)
    with pytest.warns(UserWarning, match="no C compiler"):
        path = written(identified("bouc_wen"), tmp_path)
    assert sorted(zipfile.ZipFile(path).namelist()) == [
        "modelDescription.xml", "sources/stage.c", "sources/stage.h", "sources/stage_fmu.c",
    ]  # fmt: skip
