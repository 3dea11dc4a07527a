import json
import re
from dataclasses import replace

import pandas as pd
import pytest

from pzt_ident.report.latex import escaped, tabular
from pzt_ident.report.tables import comma_separated, make_tables, write_tables
from pzt_ident.run.results import read_results


@pytest.fixture(scope="module")
def written(plain):
    tables = make_tables(read_results(plain))
    write_tables(tables, plain / "tables")
    return tables


def test_csv_gives_back_every_number(plain, written):
    result = json.loads((plain / "result.json").read_text())
    league = pd.read_csv(plain / "tables" / "league.csv")
    assert league["rmse_median [um]"].tolist() == [row["rmse_median"] for row in result["league"]]
    parameters = pd.read_csv(plain / "tables" / "parameters.csv").set_index("parameter")
    for name, entry in result["best"]["parameters"].items():
        assert parameters.loc[name, "value"] == entry["value"]
        assert parameters.loc[name, "unit"] == entry["unit"]
    runs = pd.read_csv(plain / "tables" / "runs.csv")
    assert runs["validate [um]"].tolist() == [run["rmse"]["validate"] for run in result["runs"]]
    records = pd.read_csv(plain / "tables" / "records.csv")
    assert records["sha256"].tolist() == [record["sha256"] for record in result["records"]]


def test_nothing_is_a_dash_in_print_and_empty_in_csv(weird):
    tables = make_tables(read_results(weird))
    assert tables["runs"].text["validation RMSE (x and y together) [µm]"] == ["–"]
    assert tables["runs"].data["validate (x and y together) [um]"] == [None]
    assert comma_separated(tables["runs"].data).splitlines()[1].startswith("pso-0,pso,0,0.302,,")


def test_every_axis_has_its_rmse(weird):
    records = make_tables(read_results(weird))["records"]
    assert (records.text["RMSE x [µm]"], records.text["RMSE y [µm]"]) == (["0.3000"], ["0.3100"])


def test_an_axis_has_its_rmse_in_its_own_unit(weird):
    results = read_results(weird)
    other = {"x": "um", "y": "nm"}
    records = make_tables(replace(results, result=results.result | {"units": other}))["records"]
    assert (records.text["RMSE x [µm]"], records.text["RMSE y [nm]"]) == (["0.3000"], ["0.3100"])
    assert (records.data["rmse_x [um]"], records.data["rmse_y [nm]"]) == ([0.3], [0.31])


UNITS = {
    "league": {"rmse_median", "rmse_lower_quartile", "rmse_upper_quartile", "rmse_best", "polished_rmse_median"},
    "runs": {"identify", "validate", "identify_before_polish", "validate_before_polish"},
    "records": {"rmse_x"},
}
SECONDS = {
    "league": {"seconds_median", "cpu_seconds_median"},
    "runs": {"seconds", "cpu_seconds"},
    "records": {"settle"},
}


@pytest.mark.parametrize("name", UNITS)
def test_columns_have_the_unit_of_what_they_hold_and_counts_and_shares_none(written, name):
    headings = [heading.partition(" [") for heading in written[name].data]
    units = {word: unit.removesuffix("]") for word, _, unit in headings if unit}
    rate = {"sample_rate": "Hz"} if name == "records" else {}
    assert units == dict.fromkeys(UNITS[name], "um") | dict.fromkeys(SECONDS[name], "s") | rate


def test_the_league_says_what_is_in_its_result(plain, written):
    """Each number under its own heading."""
    first = json.loads((plain / "result.json").read_text())["league"][0]
    row = {heading: cells[0] for heading, cells in written["league"].text.items()}
    for heading, word in (
        ("RMSE median", "rmse_median"),
        ("best", "rmse_best"),
        ("median after polish", "polished_rmse_median"),
    ):
        assert float(row[f"{heading} [µm]"]) == pytest.approx(first[word], rel=1e-3)
    quartiles = [float(part) for part in row["quartiles [µm]"].split(" to ")]
    assert quartiles == pytest.approx([first["rmse_lower_quartile"], first["rmse_upper_quartile"]], rel=1e-3)


def test_verdicts_are_words_in_the_table(written):
    assert set(written["parameters"].text["verdict"]) == {
        "determined",
        "on its lower bound",
        "not determined",
        "fixed",
    }


def test_latex_is_a_booktabs_tabular_with_a_cell_for_each_column(plain, written):
    for name, table in written.items():
        lines = (plain / "tables" / f"{name}.tex").read_text(encoding="utf-8").splitlines()
        align = re.fullmatch(r"\\begin\{tabular\}\{([lr]+)\}", lines[0].replace("p{60mm}", "l"))[1]
        assert len(align) == len(table.text)
        assert (lines[1], lines[3], lines[-2], lines[-1]) == (
            r"\toprule",
            r"\midrule",
            r"\bottomrule",
            r"\end{tabular}",
        )
        rows = [lines[2], *lines[4:-2]]
        assert all(len(re.split(r"(?<!\\)&", row)) == len(align) and row.endswith(r" \\") for row in rows)


def test_latex_escapes_what_a_file_may_be_called(weird):
    table = make_tables(read_results(weird))["records"]
    text = tabular(table.text, table.words)
    assert r"100\%\_\textmu{} \& " in text
    assert r"\$a\_1\$" in text
    assert r"\textless{}script\textgreater{}" in text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (r"a\b{c}", r"a\textbackslash{}b\{c\}"),
        ("~^#", r"\textasciitilde{}\textasciicircum{}\#"),
        ("(8.195 ± 0.012) × 10⁻⁸", r"(8.195 $\pm$ 0.012) $\times$ 10$^{-8}$"),
        ("−1", "$-$1"),
        ("N·s/m²", r"N$\cdot$s/m$^{2}$"),
        ("17\u202f500", r"17\,500"),
    ],
)
def test_latex_signs(text, expected):
    assert escaped(text) == expected
