import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from pzt_ident.errors import InputError
from pzt_ident.run.results import read_results


@pytest.fixture
def copy(plain, tmp_path):
    return shutil.copytree(plain, tmp_path / "copy")


def test_traces_are_in_the_order_of_the_records_then_axes(weird, plain):
    assert [(trace.record, trace.use) for trace in read_results(plain).traces] == [
        ("minor_loops.csv", "identify"),
        ("multisine.csv", "validate"),
    ]
    assert [trace.axis for trace in read_results(weird).traces] == ["x", "y"]
    assert read_results(weird).axes == ("x", "y")


def test_residual_is_model_less_response_and_units_are_read(plain):
    trace = read_results(plain).traces[0]
    np.testing.assert_allclose(trace.residual, trace.model - trace.response)
    assert (trace.drive_unit, trace.unit) == ("V", "um")


def test_the_settling_start_is_not_scored(plain):
    first, second = read_results(plain).traces
    np.testing.assert_array_equal(first.scored, first.time >= 1.0)
    assert second.scored.all()


def test_the_share_of_noise_is_that_of_the_widest_record_and_all_of_it_where_unknown(plain, weird):
    results = read_results(plain)
    spans = [np.ptp(trace.response) for trace in results.traces]
    assert spans[0] != spans[1]
    assert results.share_of_noise == pytest.approx(results.floors["x"] / max(spans))
    assert read_results(weird).share_of_noise == 1


@pytest.mark.parametrize("name", ["result.json", "history.csv", "signals.nc", "environment.json", "job.yaml"])
def test_a_missing_file_is_named(copy, name):
    (copy / name).unlink()
    with pytest.raises(InputError, match=f"{name}.*missing"):
        read_results(copy)


@pytest.mark.parametrize("name", ["result.json", "signals.nc"])
def test_a_broken_file_is_named(copy, name):
    (copy / name).write_text("{", encoding="utf-8")
    with pytest.raises(InputError, match=name):
        read_results(copy)


def test_a_folder_without_a_finished_run_is_refused(copy):
    path = copy / "result.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"best": None}))
    with pytest.raises(InputError, match="no run finished"):
        read_results(copy)


def test_an_improvement_speaks_of_its_last_model(plain):
    steps = [{"rmse": {"identify": float(i)}, "records": [{"name": f"of {i}"}], "parameters": {"a": i}} for i in (1, 2)]
    results = replace(
        read_results(plain),
        improvement={"steps": steps, "next_experiment": {"why": "last"}},
        diagnosis={"next_experiment": {"why": "first"}},
    )
    assert (results.rmse, results.records, results.parameters) == ({"identify": 2.0}, [{"name": "of 2"}], {"a": 2})
    assert results.next_experiment == {"why": "last"}
    assert replace(results, improvement={}).next_experiment == {"why": "first"}
