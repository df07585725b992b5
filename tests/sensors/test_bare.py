"""Bare arrays are the same memory; kernels that use them leave the count of holders as it was."""

import gc
import weakref

import numpy as np

from sensors.bare import bare
from sensors.compiled import compiled


@compiled
def _write(arrays, number):
    first, second = bare(arrays)
    for k in range(first.shape[0]):
        row = first[k]
        row[0] = number
        second[k] = row.shape[0]


def test_what_is_written_to_a_bare_array_is_in_the_array():
    first, second = np.zeros((3, 2)), np.zeros(3, np.int64)
    _write((first, second), 7.0)
    assert first.tolist() == [[7.0, 0.0]] * 3
    assert second.tolist() == [2, 2, 2]


def test_a_kernel_with_bare_arrays_keeps_none_and_frees_none():
    first, second = np.zeros((3, 2)), np.zeros(3, np.int64)
    watched = weakref.ref(first)
    for number in range(10):
        _write((first, second), float(number))
    assert first[0, 0] == 9.0  # it has not been freed
    del first
    gc.collect()
    assert watched() is None  # and nobody else holds it
