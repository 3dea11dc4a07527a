"""An effect more in a job file: nothing else of it changes, and bad input leaves no file."""

import difflib
import json
import os

import pytest
from click.testing import CliRunner

from pzt_ident.cli.commands import main
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import load_job

JOB = """\
# what was measured
name: small  # a name
records:
  - {file: data/slow.csv, use: identify}  # loops
  - file: /rig/steps.csv
    use: validate
    channels:
      x.response: {file: steps_x.npy, unit: um}
  - {file: "${RIG}/chirp.csv", use: validate}

channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen, lumped]
effects: [drift]   # found last week
# narrower than declared
parameters:
  bouc_wen.alpha: {bounds: [0, 1e0]}
optimizers:
  - {name: pso, population: 20, generations: 40}  # a long line is kept in one piece: it says more than any width
"""
EFFECTS = "effects: [drift]   # found last week\n"


@pytest.fixture
def job(tmp_path):
    def write(text=JOB):
        path = tmp_path / "jobs" / "job.yaml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_finer_steps_are_noted_where_they_are_not_the_jobs(job):
    text = JOB.replace("use: validate\n", "use: validate\n    steps: 2\n")
    before = load_job(job(text))
    gone, new = changed(text, edited(before, ["drift"], before.folder, steps=(4, 2, 1)))
    assert gone == ["  - {file: data/slow.csv, use: identify}  # loops"]
    assert new == ["  - {file: data/slow.csv, use: identify, steps: 4} # loops"]


@pytest.mark.parametrize("text", [JOB, JOB.replace("parameters:\n  bouc_wen.alpha: {bounds: [0, 1e0]}\n", "")])
def test_values_join_the_parameters(job, text):
    before = load_job(job(text))
    gone, new = changed(text, edited(before, ["drift"], before.folder, values={"y.amplifier_lag.tau": 0.0}))
    assert gone == []
    assert new[-1] == "  y.amplifier_lag.tau: {value: 0.0}"


def test_bounds_that_the_job_does_not_give_join_the_parameters(job):
    before = load_job(job(JOB))
    bounds = {"bouc_wen.alpha": (0.0, 2.0), "bouc_wen.beta": (1e-4, 5.0)}
    gone, new = changed(JOB, edited(before, before.effects, before.folder, bounds=bounds))
    assert [line.split("#")[0].rstrip() for line in new] == [
        "  bouc_wen.alpha: {bounds: [0.0, 2.0]}",
        "  bouc_wen.beta: {bounds: [0.0001, 5.0]}",
    ]
    assert [line.split(":")[0] for line in gone] == ["  bouc_wen.alpha"]


def call(*arguments):
    return CliRunner().invoke(main, [*map(str, arguments)])


def add(*arguments):
    return call("add", *arguments)


def changed(before, after):
    """Lines that are gone and lines that are new."""
    lines = [line for line in difflib.ndiff(before.splitlines(), after.splitlines()) if line[0] in "-+"]
    return [line[2:] for line in lines if line[0] == "-"], [line[2:] for line in lines if line[0] == "+"]


def test_one_line_changes(job):
    path = job()
    out = path.with_name("new.yaml")
    answer = add(path, "creep", "-o", out)
    assert answer.exit_code == 0
    assert f"wrote {out}: model bouc_wen, lumped; effects drift, creep" in answer.stdout
    gone, new = changed(JOB, out.read_text(encoding="utf-8"))
    assert gone == [EFFECTS.rstrip()]
    assert [line.split() for line in new] == [["effects:", "[drift,", "creep]", "#", "found", "last", "week"]]
    assert load_job(out).effects == ("drift", "creep")
    assert path.read_text(encoding="utf-8") == JOB


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("effects: []\n", ["effects: [creep]"]),
        ("effects: []  # none yet\n", ["effects: [creep] # none yet"]),
        ("", ["effects: [creep]"]),
        ("effects:\n  # slow\n  - drift  # in the hall\n", ["  - creep"]),
    ],
)
def test_wherever_effects_stand(job, before, after):
    text = JOB.replace(EFFECTS, before)
    path = job(text)
    out = path.with_name("new.yaml")
    assert add(path, "creep", "-o", out).exit_code == 0
    written = out.read_text(encoding="utf-8")
    assert changed(text, written)[1] == after
    lines = written.splitlines()
    assert lines.index(after[0]) > lines.index("model: [bouc_wen, lumped]")
    assert load_job(out).effects[-1] == "creep"


def test_what_is_removed_was_never_there(job):
    path = job()
    more, less = path.with_name("more.yaml"), path.with_name("less.yaml")
    add(path, "creep", "-o", more)
    assert call("remove", more, "creep", "-o", less).exit_code == 0
    assert load_job(less).hash == load_job(path).hash and load_job(less).effects == ("drift",)
    answer = call("remove", less, "creep", "-o", path.with_name("other.yaml"))
    assert answer.exit_code == 2 and "'creep' is not in its effects\n  it has drift" in answer.stderr


def test_another_model_keeps_comments_and_settings(job):
    path = job(JOB.replace("lumped]", "{name: rod, elements: 12}]  # long"))
    out = path.with_name("new.yaml")
    answer = call("model", path, "prandtl_ishlinskii", "rod", "-o", out)
    assert answer.exit_code == 0 and "bouc_wen.alpha" not in out.read_text()
    out.unlink()
    bare = job(JOB[: JOB.index("# narrower")].replace("lumped]", "{name: rod, elements: 12}]  # long"))
    answer = call("model", bare, "prandtl_ishlinskii", "rod", "-o", out)
    assert answer.stdout.startswith(f"wrote {out}: model prandtl_ishlinskii, rod; effects drift\n")
    assert "model: [prandtl_ishlinskii, {name: rod, elements: 12}]" in out.read_text() and "# long" in out.read_text()
    answer = call("model", bare, "bouc_wen", "bouc_wenn", "-o", path.with_name("other.yaml"))
    assert answer.exit_code == 2 and "unknown block 'bouc_wenn'" in answer.stderr


def test_a_layout_of_their_own_is_kept(job):
    wide = JOB.replace("    x: {", "        x: {").replace("  axes:", "    axes:").replace("  time:", "    time:")
    wide = wide.replace("  bouc_wen", "    bouc_wen").replace("      x.response: ", "        x.response: ")
    for text in (
        wide,
        JOB.replace("  - ", "- ").replace("    use", "  use").replace("    channels:\n  ", "  channels:\n"),
    ):
        assert changed(text, edited(load_job(job(text)), ["drift", "creep"], job().parent))[1] == [
            "effects: [drift, creep] # found last week"
        ]


def test_comments_of_what_stays_stay(job):
    text = JOB.replace(EFFECTS, "effects:\n  - drift  # in the hall\n  - delay  # one sample\n  - creep\n")
    written = edited(load_job(job(text)), ("drift", "creep"), job().parent)
    assert "  - drift  # in the hall\n" in written
    assert "delay" not in written


def test_paths_follow_the_job(job, tmp_path):
    path = job(JOB.replace('"x [um]"', "{name: x, file: data/x.npy, unit: um}"))
    out = tmp_path / "elsewhere" / "deep" / "new.yaml"
    assert add(path, "creep", "-o", out).exit_code == 0
    before, after = load_job(path), load_job(out)
    for old, new in zip(before.records, after.records, strict=True):
        assert os.path.normpath(out.parent / new.file) == os.path.normpath(path.parent / old.file) or "$" in old.file
    assert [source.file for source in after.records[1:]] == ["/rig/steps.csv", "${RIG}/chirp.csv"]
    assert after.records[0].file == os.path.join("..", "..", "jobs", "data", "slow.csv")
    assert after.records[1].channels["x.response"].file == os.path.join("..", "..", "jobs", "steps_x.npy")
    assert after.channels.axes["x"].response.file == os.path.join("..", "..", "jobs", "data", "x.npy")


def test_json_and_quiet(job):
    path = job()
    first, second = path.with_name("a.yaml"), path.with_name("b.yaml")
    answer = json.loads(add(path, "creep", "-o", first, "--json").stdout)
    assert answer == {"job": str(first), "model": ["bouc_wen", "lumped"], "effects": ["drift", "creep"]}
    answer = add(path, "creep", "-o", second, "--quiet")
    assert (answer.exit_code, answer.output, second.exists()) == (0, "", True)


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        ("crep", "unknown effect 'crep'\n  did you mean 'creep'"),
        ("drift", "'drift' is in its effects already"),
        ("bouc_wen", "'bouc_wen' is not an effect"),
        ("cross_coupling", "'cross_coupling' needs a second axis"),
    ],
)
def test_what_cannot_be_added_is_not(job, effect, message):
    path = job()
    answer = add(path, effect, "-o", path.with_name("new.yaml"))
    assert answer.exit_code == 2
    assert message in answer.stderr
    assert answer.stdout == ""
    assert list(path.parent.iterdir()) == [path]


def test_a_coupling_through_the_mechanics_needs_them(job):
    y = '    y: {drive: "u_y [V]"}\n'
    path = job(JOB.replace(", lumped]", "]").replace(EFFECTS, "").replace("model:", y.lstrip("\n") + "model:", 1))
    answer = add(path, "cross_coupling.stiffness", "-o", path.with_name("new.yaml"))
    assert answer.exit_code == 2
    assert "'cross_coupling.stiffness' acts through the mechanics" in answer.stderr
    assert "put this into `model`: lumped" in answer.stderr


def test_a_term_needs_its_block(job):
    path = job(JOB.replace(", lumped]", "]").replace(EFFECTS, ""))
    answer = add(path, "viscous_damping", "-o", path.with_name("new.yaml"))
    assert answer.exit_code == 2
    assert "no block of this model has a term for 'viscous_damping'" in answer.stderr


def test_no_file_is_overwritten(job):
    path = job()
    answer = add(path, "creep", "-o", path)
    assert answer.exit_code == 2
    assert f"{path}: exists already\n  give another file with -o" in answer.stderr
    assert path.read_text(encoding="utf-8") == JOB


def test_no_job_no_file(tmp_path):
    answer = add(tmp_path / "job.yaml", "creep", "-o", tmp_path / "new.yaml")
    assert answer.exit_code == 2
    assert "no such file" in answer.stderr
    assert not list(tmp_path.iterdir())


SAID = """\
records: [{file: a.csv, use: identify}]
channels:
  time: "t [s]"
  axes: {x: {drive: "u [V]", response: "x [um]"}}
model: [bouc_wen, lumped]
effects: [creep]
parameters:
  bouc_wen.alpha: {value: 0.4}
  lumped.mass: {value: 0.2}
  creep.ratio: {bounds: [0, 0.2]}
"""


@pytest.mark.parametrize(
    ("command", "words", "left"),
    [
        ("model", ["prandtl_ishlinskii", "lumped"], ["lumped.mass", "creep.ratio"]),
        ("remove", ["creep"], ["bouc_wen.alpha", "lumped.mass"]),
        ("model", ["prandtl_ishlinskii"], ["creep.ratio"]),
    ],
)
def test_what_a_job_says_of_a_block_goes_with_it(tmp_path, command, words, left):
    (tmp_path / "job.yaml").write_text(SAID)
    line = [command, str(tmp_path / "job.yaml"), *words, "-o", str(tmp_path / "new.yaml")]
    answer = CliRunner().invoke(main, line)
    assert answer.exit_code == 0, answer.output
    assert list(load_job(tmp_path / "new.yaml").parameters) == left
