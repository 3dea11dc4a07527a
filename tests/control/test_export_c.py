"""The exported C is the stage in real time."""

import subprocess
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st

from contracts.test_blocks import ALONE, at
from exports import LONG, compiled, identified, is_tame, needs_compiler
from pzt_ident.control.export import c
from pzt_ident.errors import InputError
from pzt_ident.model.block import Block, Place
from rig import model

CHOICES = [["", *map(str, at(place))] for place in Place]
INVERTED = [
    "bouc_wen",
    "delay amplifier_lag quadratic_gain distributed_memory bouc_wen asymmetry rate_dependence creep sensor_lag",
    "bouc_wen saturation friction cross_coupling kinematic_coupling",
    "homogenized_energy thermal_relaxation creep:elements",
]
RELAYS = "thermal_homogenized_energy"


@needs_compiler
@pytest.mark.parametrize("precision", ["double", "float"])
def test_every_block_in_c_responds_as_here(precision, tmp_path):
    words = [*ALONE, *LONG] if precision == "double" else [*ALONE[1::12], *LONG]
    models = [identified(each, name=f"m{i} {each.split()[0]}") for i, each in enumerate(words)]
    program = compiled(models, tmp_path, precision, inverse=False, apart=False)
    ran = subprocess.run([program], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stdout + ran.stderr


@needs_compiler
@settings(
    deadline=None,
    max_examples=6,
    derandomize=True,
    phases=[Phase.generate],
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(words=st.tuples(*map(st.sampled_from, CHOICES)), seed=st.integers(0, 1000), unmeasured=st.booleans())
def test_any_chain_in_c_responds_as_here(words, seed, unmeasured, tmp_path):
    one = identified(" ".join(filter(None, words)) or "bouc_wen", seed, unmeasured=unmeasured and "modal" not in words)
    assume(is_tame(one))
    ran = subprocess.run([compiled([one], tmp_path, inverse=False)], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stdout + ran.stderr


@needs_compiler
@pytest.mark.parametrize("precision", ["double", "float"])
def test_inverse_in_c_is_the_one_here(precision, tmp_path):
    models = [identified(words, 2, 1e-3, f"m{i} {words.split()[0]}") for i, words in enumerate(INVERTED)]
    ran = subprocess.run([compiled(models, tmp_path, precision)], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert ran.stdout.count("of the inverse") == len(INVERTED)


@pytest.mark.parametrize(
    ("words", "why"), [("bouc_wen_oscillator", "stepped finer"), ("bouc_wen lumped cubic_stiffness", "not linear")]
)
def test_header_says_why_there_is_no_inverse(words, why):
    header = c.files(identified(words))["stage.h"]
    assert why in header.partition("No inverse: ")[2]


def test_source_reads_as_the_author_wrote_it():
    made = c.files(identified("bouc_wen lumped", name="x axis"))
    assert set(made) == {"x_axis.h", "x_axis.c", "x_axis_test.c"}
    assert "bouc_wen: y = d u - h, dh/dt = alpha d du/dt - beta |du/dt| h - gamma du/dt |h|." in made["x_axis.h"]
    assert "return gain * u - slope * h;" in made["x_axis.c"]
    assert max(map(len, made["x_axis.c"].splitlines())) <= 120


def test_what_no_c_can_be_written_for_is_named():
    class Sorted(Block):
        """y = the larger of two: <-."""

        place = Place.STATIC

        def prepare():
            return ()

        def start(u):
            return ()

        def step(u):
            return sorted([u, -u])[1]

    one = identified("bouc_wen")
    chain = model("bouc_wen", Sorted)
    with pytest.raises(InputError, match=r"step: line \d+: `.*` cannot be exported"):
        c.files(replace(one, chain=chain))


def test_relays_need_double():
    with pytest.raises(InputError, match="thermal_homogenized_energy: single precision"):
        c.files(identified(RELAYS), "float")
