"""What the library does to the process that it runs in."""

import numpy as np
from threadpoolctl import threadpool_info

from pzt_ident.run.computing import computing


def threads():
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_blas_keeps_to_one_thread_while_it_computes_and_has_its_own_back():
    before = threads()
    with computing():
        assert threads() == {1}
        np.exp(np.array([1e4]))  # no warning
    assert threads() == before
