"""Laws over the readers: what is a reader of a file format, is tested by being there."""

import gzip
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from pzt_ident.atlas.manual import code_blocks, source
from pzt_ident.data import formats
from pzt_ident.data.readers import registry
from pzt_ident.data.readers.open import open_table, parts_of
from pzt_ident.data.readers.registry import Readers, readers
from pzt_ident.data.record import Channel, Source
from pzt_ident.errors import InputError
from pzt_ident.job.schema import load_job
from pzt_ident.run.summary import summary_of
from sheets import write_sheets

ALL = list(readers)
SIGNALS = {"t [s]": np.arange(400.0), "u [V]": np.arange(400) % 7.0, "x [um]": np.arange(400) % 5.0}


@pytest.fixture
def example(tmp_path):
    """The reader that the manual shows, in a file."""
    (code,) = (code.text for code in code_blocks(source("50_your_own.md")) if code.file == "force_curves.py")
    (tmp_path / "force_curves.py").write_text(code, encoding="utf-8")
    before = readers._added
    yield tmp_path / "force_curves.py"
    readers._added = before
    sys.modules.pop("pzt_ident_plugins.force_curves", None)


def load_everything(path):
    """As a job does that takes every column of every part of the file."""
    key, parts = parts_of(path)
    for part in parts or [None]:
        for column in open_table(path, Source(str(path), **({key: part} if part else {}))).columns:
            column.load()


def refusal(path, problem):
    """The one InputError of a file that is read as a record."""
    channels = [Channel(column=k, unit=unit) for k, unit in ((1, "V"), (2, "um"))]
    return problem(path, *channels, None, sample_rate=1)


@pytest.mark.parametrize("reader", ALL, ids=lambda reader: reader.name)
def test_declares_what_it_reads(reader):
    assert reader.suffixes
    assert len(sys.modules[f"pzt_ident.data.formats.{reader.name}"].__doc__) > 20


def test_no_suffix_and_no_first_bytes_are_shared():
    suffixes = [suffix for reader in ALL for suffix in reader.suffixes]
    assert len(set(suffixes)) == len(suffixes)
    magic = [(reader.name, first) for reader in ALL for first in reader.magic]
    assert not [(a, b) for a in magic for b in magic if a != b and a[1].startswith(b[1])]


@pytest.mark.parametrize("suffix", readers.suffixes())
def test_an_empty_file_is_an_input_error(tmp_path, problem, suffix):
    path = tmp_path / f"empty{suffix}"
    path.touch()
    assert refusal(path, problem).message == "the file is empty"


@pytest.mark.parametrize("suffix", readers.suffixes())
def test_text_under_its_suffix_is_an_input_error(tmp_path, problem, suffix):
    path = tmp_path / f"text{suffix}"
    path.write_text("The recording is on the other disk.\nAsk for it.\n")
    assert refusal(path, problem).message


@pytest.mark.parametrize("magic", [magic for reader in ALL for magic in reader.magic])
@pytest.mark.parametrize("name", ["cut", "cut.dat"])
def test_a_file_cut_behind_its_first_bytes_is_an_input_error(tmp_path, problem, magic, name):
    (tmp_path / name).write_bytes(magic + b"\0")
    assert refusal(tmp_path / name, problem).message


def write_text(path):
    rows = zip(*SIGNALS.values(), strict=True)
    path.write_text("\n".join([",".join(SIGNALS), *(",".join(map(str, row)) for row in rows)]))


def write_mat(path):
    from scipy.io import savemat

    savemat(path, {name[0]: signal for name, signal in SIGNALS.items()})


def write_hdf5(path):
    import h5py

    with h5py.File(path, "w") as file:
        for name, signal in SIGNALS.items():
            file[name[0]] = signal


def write_npy(path):
    np.save(path, np.stack(list(SIGNALS.values()), axis=1))


def write_npz(path):
    np.savez_compressed(path, **SIGNALS)


def write_gz(path):
    write_text(path)
    path.write_bytes(gzip.compress(path.read_bytes()))


def write_tdms(path):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("Log", name, signal) for name, signal in SIGNALS.items()])


def write_parquet(path):
    pyarrow = pytest.importorskip("pyarrow")
    pytest.importorskip("pyarrow.parquet").write_table(pyarrow.table(SIGNALS), path)


def write_excel(path):
    write_sheets(path, Loop=[list(SIGNALS), *(list(map(float, row)) for row in zip(*SIGNALS.values(), strict=True))])


WRITERS = {
    ".csv": write_text,
    ".mat": write_mat,
    ".h5": write_hdf5,
    ".npy": write_npy,
    ".npz": write_npz,
    ".gz": write_gz,
    ".tdms": write_tdms,
    ".parquet": write_parquet,
    ".xlsx": write_excel,
}


@pytest.mark.parametrize("suffix", WRITERS)
def test_a_truncated_file_is_an_input_error(tmp_path, problem, suffix):
    path = tmp_path / f"complete{suffix}"
    WRITERS[suffix](path)
    load_everything(path)
    content = path.read_bytes()
    half = len(content) // 2
    if suffix == ".csv":
        half = content.index(b",", half)  # a number that is cut is still a number
    (tmp_path / f"half{suffix}").write_bytes(content[:half])
    assert refusal(tmp_path / f"half{suffix}", problem).message


def test_every_format_of_the_package_is_truncated():
    assert {next(reader.name for reader in ALL if suffix in reader.suffixes) for suffix in WRITERS} == {
        reader.name for reader in ALL if reader.file.startswith(str(Path(formats.__file__).parent))
    }


def test_reading_text_imports_no_library_of_another_format(tmp_path):
    write_text(tmp_path / "loop.csv")
    heavy = ("h5py", "scipy", "pyarrow", "nptdms", "python_calamine", "pandas")
    code = (
        "import sys; from pathlib import Path; from pzt_ident.data.readers.open import open_table\n"
        "from pzt_ident.data.record import Source\n"
        "[column.load() for column in open_table(Path('loop.csv'), Source('loop.csv')).columns]\n"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


SOUND = {"__doc__": "Curves of our AFM.", "SUFFIXES": (".fcrv",), "read": lambda path, source: None}


def module(**changes):
    """A module that declares a reader, with something else in it or, by None, without."""
    curves = ModuleType("curves")
    curves.__file__ = "curves.py"
    vars(curves).update({name: value for name, value in (SOUND | changes).items() if value is not None})
    return curves


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"__doc__": ""}, "has no docstring"),
        ({"SUFFIXES": None}, "does not declare its suffixes"),
        ({"SUFFIXES": ()}, "does not declare its suffixes"),
        ({"SUFFIXES": ".fcrv"}, "does not declare its suffixes"),
        ({"SUFFIXES": ("fcrv",)}, "does not declare its suffixes"),
        ({"SUFFIXES": (".FCRV",)}, "does not declare its suffixes"),
        ({"SUFFIXES": (".fcrv.gz",)}, "does not declare its suffixes"),
        ({"MAGIC": b"FCRV"}, "MAGIC is not a tuple of bytes"),
        ({"MAGIC": ("FCRV",)}, "MAGIC is not a tuple of bytes"),
        ({"MAGIC": (b"",)}, "MAGIC is not a tuple of bytes"),
        ({"read": None}, "has no function `read`"),
        ({"read": "a.csv"}, "has no function `read`"),
        ({"read": lambda path: None}, "`read` cannot be called with 2 arguments"),
        ({"parts": lambda: None}, "`parts` cannot be called with 1 argument"),
        ({"SUFFIXES": (".fcrv", ".csv")}, "the suffix '.csv' is taken by the reader `text`"),
        ({"MAGIC": (b"PK",)}, "the first bytes b'PK' are taken by the reader `excel`"),
    ],
)
def test_what_breaks_the_contract_is_said_in_one_sentence(changes, message):
    with pytest.raises(InputError) as raised:
        Readers().add(module(**changes))
    assert (raised.value.message, raised.value.where) == (message, "curves.py")
    assert raised.value.remedy and "\n" not in raised.value.remedy


def test_a_file_that_was_mended_takes_the_place_of_its_reader():
    known = Readers()
    known.add(module())
    known.add(module(MAGIC=(b"FCRV",)))
    assert [reader.magic for reader in known if ".fcrv" in reader.suffixes] == [(b"FCRV",)]


def test_a_reader_that_returns_no_table_is_named(tmp_path, monkeypatch):
    known = Readers()
    known.add(module(read=lambda path, source: [1, 2]))
    monkeypatch.setattr("pzt_ident.data.readers.open.readers", known)
    (tmp_path / "a.fcrv").write_text("1")
    with pytest.raises(InputError, match=r"curves.py: `read` returns list instead of a Table"):
        open_table(tmp_path / "a.fcrv", Source("a.fcrv"))


@pytest.fixture
def installed(monkeypatch, tmp_path):
    """Readers as they are where entry points name these modules."""

    def install(**modules):
        for name, text in modules.items():
            (tmp_path / f"{name}.py").write_text(text)
            monkeypatch.delitem(sys.modules, name, raising=False)
        entries = [EntryPoint(name, name, registry.GROUP) for name in modules]
        monkeypatch.setattr(registry, "entry_points", lambda group: entries if group == registry.GROUP else [])
        return Readers()

    monkeypatch.syspath_prepend(tmp_path)
    return install


def test_an_entry_point_brings_a_reader(installed, example):
    known = installed(afm_curves=example.read_text())
    assert known.find(Path("a.FCRV")).name == "afm_curves"


def test_an_entry_point_that_cannot_be_used_leaves_the_others(installed, example):
    text = example.read_text()
    known = installed(broken="import no_such_module\n", taken=text.replace(".fcrv", ".csv"), afm_curves=text)
    with pytest.warns(UserWarning) as warned:
        assert ".fcrv" in known.suffixes()
    assert [str(item.message).partition("\n")[0] for item in warned] == [
        "entry point `broken = broken`: ModuleNotFoundError: No module named 'no_such_module'",
        f"entry point `taken = taken`: {example.parent / 'taken.py'}: the suffix '.csv' is taken by the reader `text`",
    ]
    assert [reader.name for reader in known if ".csv" in reader.suffixes] == ["text"]


JOB = """\
plugins: [force_curves.py]
records:
  - {file: loop.fcrv, use: identify}
channels:
  time: time [s]
  axes:
    x: {drive: "u [V]", response: "x [um]"}
model: [bouc_wen]
optimizers: [{name: least_squares, budget: 60}]
"""


def test_a_plugin_of_a_job_brings_the_reader_of_its_data(example):
    signals = np.stack(list(SIGNALS.values()), axis=1).astype("<f4")
    (example.parent / "loop.fcrv").write_bytes(b"FCRV" + signals.tobytes())
    (example.parent / "job.yaml").write_text(JOB)
    for _ in range(2):
        facts = summary_of(load_job(example.parent / "job.yaml", plugins=True))
        assert facts["records"][0]["samples"] == 400
    (example.parent / "loop.fcrv").write_bytes(b"FCRV" + signals.tobytes()[:-2])
    with pytest.raises(InputError, match=r"loop\.fcrv: cannot be read as force_curves"):
        summary_of(load_job(example.parent / "job.yaml", plugins=True))


def test_a_plugin_that_breaks_the_contract_is_a_fault_of_the_job(example):
    example.write_text(example.read_text().replace(".fcrv", ".csv"))
    (example.parent / "job.yaml").write_text(JOB)
    with pytest.raises(InputError, match=r"job\.yaml:1:11: plugins\[0\].*suffix '\.csv' is taken by the reader `text`"):
        load_job(example.parent / "job.yaml", plugins=True)
