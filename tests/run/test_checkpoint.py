"""What a search leaves on the disk while it runs, torn anywhere, and the curve that is drawn of it."""

import numpy as np
import pytest

from pzt_ident.run.checkpoint import Checkpoint, Generation, read_losses
from pzt_ident.run.collect import history_of, history_text
from pzt_ident.run.task import Task

GENERATIONS = [
    Generation(0.5, np.array([3e-6, np.inf, 4e-6])),
    Generation(1.25, np.array([5e-6])),
    Generation(2.0, np.array([np.inf, 1e-6])),
]
ENDS = np.cumsum([20 + 8 * 3, 20 + 8, 20 + 8 * 2])  # bytes: seconds, count, check, losses


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "runs" / "pso-0.losses"
    checkpoint = Checkpoint()
    with checkpoint.appending() as append:
        for generation in GENERATIONS:
            append(*generation)
    checkpoint.save(path)
    return path


def assert_same(found, expected):
    assert [generation.raw for generation in found] == [generation.raw for generation in expected]


def test_wherever_a_file_is_torn_its_whole_generations_are_read(path):
    raw = path.read_bytes()
    assert len(raw) == ENDS[-1]
    for length in range(len(raw) + 1):
        path.write_bytes(raw[:length])
        assert_same(read_losses(path), GENERATIONS[: np.searchsorted(ENDS, length, side="right")])


def test_wherever_a_byte_is_changed_what_is_before_it_is_read(path):
    raw = path.read_bytes()
    for place in range(len(raw)):
        path.write_bytes(raw[:place] + bytes([raw[place] ^ 0x55]) + raw[place + 1 :])
        assert_same(read_losses(path), GENERATIONS[: np.searchsorted(ENDS, place, side="right")])


def test_what_is_appended_takes_the_place_of_what_was_torn(path):
    path.write_bytes(path.read_bytes()[:-3])
    with Checkpoint(path).appending() as append:
        append(3.0, np.array([7.0]))
    assert_same(read_losses(path), [*GENERATIONS[:2], Generation(3.0, np.array([7.0]))])


def test_a_search_goes_on_from_its_last_second_and_its_failures(path):
    found = Checkpoint(path)
    assert (found.seconds, found.failures) == (2.0, 2)
    assert (Checkpoint(path.with_name("none")).seconds, Checkpoint().failures) == (0.0, 0)


def test_the_curve_is_the_best_so_far_over_all_evaluations_so_far_in_the_users_unit(path):
    task = Task("pso-0", "pso", {}, 0, 1, {}, True, path.parent.parent)
    history = history_of(task, 1e-6)
    np.testing.assert_allclose(history, [(3, 0.5, 3), (4, 1.25, 3), (6, 2, 1)], rtol=1e-12)
    assert history_text([task], {"pso-0": history}).splitlines() == [
        "optimizer,repeat,generation,evaluations,seconds,best",
        "pso,0,1,3,0.5,3",
        "pso,0,2,4,1.25,3",
        "pso,0,3,6,2,1",
    ]
