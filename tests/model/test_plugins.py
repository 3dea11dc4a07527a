"""An effect in a file of the user's: joins the catalogue where it is asked for, and only there."""

import re
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from pzt_ident.cli.commands import main
from pzt_ident.diagnosis.score import applicable
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks
from pzt_ident.run.improve import opened_case

README = Path(__file__).parents[2] / "README.md"
JOB = """\
plugins: [cubic_gain.py]
name: own
records:
  - {file: data.csv, use: identify}
channels:
  time: time [s]
  axes:
    x: {drive: "u [V]", response: "x [um]"}
model: [bouc_wen]
effects: [cubic_gain]
optimizers:
  - {name: least_squares, budget: 60}
"""


@pytest.fixture
def folder(tmp_path):
    """A job beside its data and the recipe of README."""
    recipe = next(
        code for code in re.findall(r"```python\n(.*?)```", README.read_text("utf-8"), re.S) if "CubicGain" in code
    )
    (tmp_path / "cubic_gain.py").write_text(recipe, encoding="utf-8")
    (tmp_path / "job.yaml").write_text(JOB, encoding="utf-8")
    rows = [f"{i * 1e-2:.2f},{u},{0.08 * u + 1e-6 * u**3:.6f}" for i, u in enumerate([*range(60), *range(60, 0, -1)])]
    (tmp_path / "data.csv").write_text("time [s],u [V],x [um]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    yield tmp_path
    blocks._items.pop("cubic_gain", None)
    sys.modules.pop("pzt_ident_plugins.cubic_gain", None)


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_no_code_runs_that_was_not_asked_for(folder):
    (folder / "cubic_gain.py").write_text("raise SystemExit('ran')")
    said = call("check", folder / "job.yaml")
    assert said.exit_code == 2
    assert "would run as code" in said.stderr and "--plugins" in said.stderr
    assert "cubic_gain" not in blocks


def test_it_is_identified_like_any_other(folder):
    ended = call("run", folder / "job.yaml", "--plugins", "--out", folder / "out", "--workers", "1", "--no-report")
    assert ended.exit_code == 0, ended.output
    assert "cubic_gain.bend" in ended.stdout
    assert call("resume", folder / "out").exit_code == 2
    assert call("resume", folder / "out", "--plugins", "--no-report").exit_code == 0


def test_it_joins_the_diagnosis(folder):
    plain = folder / "plain.yaml"
    plain.write_text(JOB.replace("effects: [cubic_gain]", "effects: []"))
    with opened_case(load_job(plain, plugins=True), folder / "out") as (case, _):
        assert "cubic_gain" in applicable(case, ())


def test_what_the_user_rules_out_does_not(folder):
    ruled = folder / "ruled.yaml"
    ruled.write_text(JOB.replace("effects: [cubic_gain]", "rule_out: [cubic_gain, creep]"))
    with opened_case(load_job(ruled, plugins=True), folder / "out") as (case, _):
        assert not {"cubic_gain", "creep"} & set(applicable(case, ()))


def test_a_job_elsewhere_still_finds_its_files(folder):
    (folder / "sub").mkdir()
    plain = folder / "plain.yaml"
    plain.write_text(JOB.replace("effects: [cubic_gain]", "effects: []"))
    out = folder / "sub" / "more.yaml"
    assert call("add", plain, "cubic_gain", "-o", out, "--plugins").exit_code == 0
    assert load_job(out, plugins=True).plugins == ("../cubic_gain.py",)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('("saturation",)', '("saturaton",)', ["CubicGain.look_alikes: unknown effect 'saturaton'", "'saturation'?"]),
        ("null=0", 'null=0, effect="crep"', ["CubicGain.bend: unknown effect 'crep'", "'creep'?"]),
        ("return u + bend * u * u * u", "return cube(u)", ["CubicGain.step: raises TypeError in line"]),
        ("prepare(bend)", "prepare(bent)", ["CubicGain.prepare: asks for 'bent'", "'bend'?"]),
    ],
)
def test_what_a_file_breaks_is_said_of_the_job(folder, old, new, expected):
    recipe = (folder / "cubic_gain.py").read_text()
    assert old in recipe
    (folder / "cubic_gain.py").write_text(recipe.replace(old, new) + "\n\ndef cube():\n    return 0.0\n")
    said = call("check", folder / "job.yaml", "--plugins")
    assert said.exit_code == 2
    assert all(part in said.stderr for part in expected), said.stderr


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("own.py", "x = 1", "registers no block"),
        ("own.py", "1 / 0", "ZeroDivisionError"),
        ("creep.py", "", "cannot name an effect"),
        ("none.py", None, "no such file"),
    ],
)
def test_a_bad_file_is_named_with_what_is_wrong(tmp_path, name, text, said):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=said) as raised:
        blocks.plug(tmp_path / name)
    assert raised.value.where == str(tmp_path / name)


def test_a_word_that_rules_out_nothing(folder):
    (folder / "job.yaml").write_text(JOB + "rule_out: [crep]\n")
    with pytest.raises(InputError, match="unknown effect 'crep'"):
        load_job(folder / "job.yaml", plugins=True)
