import json
import re

import pandas as pd
import pytest

from pzt_ident.report.latex import escaped, tabular
from pzt_ident.report.tables import make_tables, write_tables
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
    assert tables["runs"].text["validate (x and y together) [µm]"].tolist() == ["–"]
    assert tables["runs"].data["validate (x and y together) [um]"].isna().all()


def test_every_axis_has_its_rmse(weird):
    records = make_tables(read_results(weird))["records"]
    assert records.text[["RMSE x [µm]", "RMSE y [µm]"]].iloc[0].tolist() == ["0.3000", "0.3100"]


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
        assert len(align) == len(table.text.columns)
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
