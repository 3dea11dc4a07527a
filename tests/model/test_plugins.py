"""An effect in a file of the user's: joins the catalogue where it is asked for, and only there."""

import json
import sys

import pytest
from click.testing import CliRunner

from pzt_ident.atlas.manual import code_blocks, source
from pzt_ident.cli.commands import main
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.run.improve import opened_case

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

EVERY_WORD = [*blocks, *optimizers]  # is loaded before any is taken back


@pytest.fixture
def folder(tmp_path):
    """A job beside its data and the recipe of the manual."""
    (recipe,) = (code.text for code in code_blocks(source("50_your_own.md")) if code.file == "cubic_gain.py")
    (tmp_path / "cubic_gain.py").write_text(recipe, encoding="utf-8")
    (tmp_path / "job.yaml").write_text(JOB, encoding="utf-8")
    rows = [f"{i * 1e-2:.2f},{u},{0.08 * u + 1e-6 * u**3:.6f}" for i, u in enumerate([*range(60), *range(60, 0, -1)])]
    (tmp_path / "data.csv").write_text("time [s],u [V],x [um]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    known = [(registry, dict(registry._items)) for registry in (blocks, optimizers)]
    yield tmp_path
    for registry, items in known:
        registry._items.clear()
        registry._items.update(items)
    for name in ("cubic_gain", "random_walk"):
        sys.modules.pop(f"pzt_ident_plugins.{name}", None)


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


@pytest.mark.parametrize("source", ["cubic_gain.py", "job.yaml", "broken.yaml"])
def test_it_is_listed_and_shown(folder, source):
    (folder / "broken.yaml").write_text(JOB.replace("bouc_wen", "bouc_wenn"))
    assert "cubic_gain" in json.loads(call("list", "effects", "--json", "--plugins", folder / source).stdout)
    shown = call("show", "cubic_gain", "--plugins", folder / source)
    assert shown.stdout.startswith("cubic_gain (effects)\n")
    assert "To do: Linearise the drive" in shown.stdout


def test_it_is_neither_without_its_file(folder):
    assert "cubic_gain" not in json.loads(call("list", "effects", "--json").stdout)
    assert "unknown word 'cubic_gain'" in call("show", "cubic_gain").stderr


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("none.py", None, "none.py: no such file"),
        ("none.yaml", None, "none.yaml: no such file"),
        ("job.yaml", "name: own\n", "job.yaml: lists no `plugins`\n  give a job that does"),
        ("job.yaml", "- own\n", "job.yaml:1:1: the job is a list"),
        ("job.yaml", "plugins: own.py\n", "job.yaml:1:10: plugins: 'own.py' is not a list"),
        ("job.yaml", "plugins: [own.py]\n", "job.yaml:1:11: plugins[0]: no such file"),
    ],
)
def test_what_brings_no_code_is_said(tmp_path, name, text, said):
    if text is not None:
        (tmp_path / name).write_text(text)
    ended = call("show", "creep", "--plugins", tmp_path / name)
    assert ended.exit_code == 2 and said in ended.stderr


def test_completion_in_a_shell_runs_no_code(folder):
    (folder / "cubic_gain.py").write_text("raise SystemExit('ran')")
    words = {"COMP_WORDS": f"pzt-ident show --plugins {folder / 'cubic_gain.py'} ", "COMP_CWORD": "4"}
    ended = CliRunner().invoke(main, [], prog_name="pzt-ident", env={"_PZT_IDENT_COMPLETE": "bash_complete"} | words)
    assert ended.exit_code == 0 and "ran" not in ended.output


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
        ("own.py", "x = 1", r"a reader has `SUFFIXES`"),
        ("own.py", "x = 1\n1 / 0", "ZeroDivisionError in line 2: division"),
        ("own.py", "x = 1\n\ny = (", "SyntaxError in line 3"),
        ("creep.py", "", "'creep' is taken by a built-in block or effect"),
        ("my-gain.py", "", "'my-gain' is no word for an effect"),
        ("none.py", None, "no such file"),
    ],
)
def test_a_bad_file_is_named_with_what_is_wrong(tmp_path, name, text, said):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=said) as raised:
        blocks.plug(tmp_path / name)
    assert raised.value.where == str(tmp_path / name)


def test_an_unknown_look_alike_is_said_where_no_job_is_read(tmp_path):
    (tmp_path / "own_lag.py").write_text(OWN.replace("one's own", "ours") + "    look_alikes = ('frictoin',)\n")
    try:
        said = call("show", "own_lag", "--plugins", tmp_path / "own_lag.py")
        assert said.exit_code == 2 and "Own.look_alikes: unknown effect 'frictoin'" in said.stderr
        assert "did you mean 'friction'" in said.stderr
    finally:
        blocks._items.pop("own_lag", None)
        sys.modules.pop("pzt_ident_plugins.own_lag", None)


def test_a_word_that_rules_out_nothing(folder):
    (folder / "job.yaml").write_text(JOB + "rule_out: [crep]\n")
    with pytest.raises(InputError, match="unknown effect 'crep'"):
        load_job(folder / "job.yaml", plugins=True)


def test_a_file_that_was_mended_is_read_again(tmp_path, monkeypatch):
    """Within a second, to the same size, too; nothing is left beside it."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    path = tmp_path / "own.py"
    for text, said in (("x = 1", "registers no block"), ("1 / 0", "ZeroDivisionError"), (OWN + "1 / 0", "Zero")):
        path.write_text(text)
        with pytest.raises(InputError, match=said):
            blocks.plug(path)
    path.write_text(OWN)
    blocks.plug(path)
    assert "own" in blocks and list(tmp_path.iterdir()) == [path]
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "own.py").write_text(OWN)
    with pytest.raises(InputError, match="'own' is taken by another block or effect"):
        blocks.plug(tmp_path / "other" / "own.py")
    del blocks._items["own"], sys.modules["pzt_ident_plugins.own"]


OWN = "from pzt_ident.effects.creep import Creep\nfrom pzt_ident.model.registry import blocks\n"
OWN += "@blocks.register\nclass Own(Creep):\n    '''Creep of one's own.'''\n"


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """A distribution with these entry points and modules; `own` is one of an effect."""

    def install(name, entries, **modules):
        about = tmp_path / f"{name}-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text("[pzt_ident.block]\n" + entries)
        for module, text in modules.items():
            (tmp_path / f"{module}.py").write_text(text)
            monkeypatch.delitem(sys.modules, module, raising=False)

    monkeypatch.syspath_prepend(tmp_path)
    before = dict(blocks._items)
    monkeypatch.delitem(vars(blocks), "_entries", raising=False)
    yield install
    vars(blocks).pop("_entries", None)
    blocks._items.clear()
    blocks._items.update(before)


def test_an_entry_point_brings_an_effect(installed):
    installed("mylab", "own = own:Own\n", own=OWN)
    assert "own" in blocks.effects() and call("show", "own").exit_code == 0
    assert blocks.kind_of("own") == "effects"


def test_no_entry_point_replaces_a_built_in_effect(installed):
    installed("mylab", "creep = own:Own\n", own=OWN)
    shown = call("show", "creep")
    assert (shown.exit_code, shown.stdout) == (2, "")
    assert "`creep = own:Own` of mylab 1.0: 'creep' is taken by a built-in block or effect" in shown.stderr
    assert "own" not in sys.modules
    with pytest.warns(UserWarning, match="is taken by a built-in"):
        assert "drift" in blocks.effects()


def test_no_module_replaces_a_built_in_effect(installed):
    installed("mylab", "fine = creep:Own\n", creep=OWN)
    with pytest.raises(InputError, match=r"`fine = creep:Own` of mylab 1\.0: 'creep' is taken by a built-in"):
        blocks["fine"]
    assert blocks["creep"].__module__ == "pzt_ident.effects.creep"


def test_two_entry_points_of_one_word_are_both_refused(installed):
    installed("mylab", "own = own:Own\n", own=OWN)
    installed("yourlab", "own = other:Own\n", other=OWN)
    with pytest.raises(InputError, match="'own' is taken by another block or effect"):
        blocks["own"]


def test_an_entry_point_that_fails_leaves_the_others(installed, folder):
    installed("mylab", "own = missing_module:Own\n")
    said = call("show", "own")
    assert said.exit_code == 2
    assert "`own = missing_module:Own` of mylab 1.0: ModuleNotFoundError: No module named" in said.stderr
    with pytest.warns(UserWarning, match="missing_module"):
        assert call("list", "effects").exit_code == 0
        (folder / "job.yaml").write_text(JOB.replace("plugins: [cubic_gain.py]\n", "").replace("cubic_gain", "creep"))
        assert call("check", folder / "job.yaml").exit_code == 0
        (folder / "job.yaml").write_text(JOB.replace("plugins: [cubic_gain.py]\n", "").replace("cubic_gain", "own"))
        said = call("check", folder / "job.yaml")
    assert said.exit_code == 2 and "job.yaml" in said.stderr and "of mylab 1.0: ModuleNotFoundError" in said.stderr


WALK = '''
from dataclasses import dataclass

import numpy as np

from pzt_ident.model.optimizer import Generational
from pzt_ident.model.registry import optimizers


@optimizers.register
@dataclass(frozen=True)
class RandomWalk(Generational):
    """Steps about the best point so far, shorter and shorter."""

    source = "For this test."
    convergent = False

    def search(self, dimensions, rng):
        best, least, size = rng.random(dimensions), np.inf, 0.5
        while True:
            points = np.clip(best + size * rng.normal(size=(self.population, dimensions)), 0, 1)
            losses = yield points
            if losses.min() < least:
                best, least = points[losses.argmin()], losses.min()
            size *= 0.97
'''


def test_a_file_may_bring_an_optimizer(folder):
    """One file, in the job's own words, in every worker."""
    (folder / "random_walk.py").write_text(WALK)
    job = JOB.replace("[cubic_gain.py]", "[cubic_gain.py, random_walk.py]")
    (folder / "job.yaml").write_text(
        job.replace("name: least_squares, budget: 60", "name: random_walk, population: 20")
    )
    arguments = ["run", folder / "job.yaml", "--out", folder / "out", "--plugins", "--no-report", "--quiet"]
    shown = call(*arguments)
    assert shown.exit_code == 0, shown.stderr
    result = json.loads((folder / "out" / "result.json").read_text())
    assert result["best"]["optimizer"] == "random_walk" and result["best"]["evaluations"] == 20 * 250
