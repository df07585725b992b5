"""What is encoded for many robots at once, against the layouts and rules for one."""

from types import SimpleNamespace

import numpy as np
import pytest

from player import layouts, messages
from player.codes import Interface
from sensors.readings import BLOB, Blobs, Scans
from sim.devices.encoding import ENCODERS, GroupEncoder, told

RANDOM = np.random.default_rng(7)
N = 6


def group_of(readings, rows):
    return SimpleNamespace(readings=readings, rows=np.array(rows, np.int64))


def scans():
    """Scans among which some have hit something at the end of the range, and beyond by rounding."""
    found = Scans.empty(N, 30, 3.0, 8.1)
    found.ranges[:] = RANDOM.uniform(0.0, 8.1, (N, 30))
    found.ranges[RANDOM.random((N, 30)) < 0.3] = 8.1
    found.hits[:] = RANDOM.integers(-1, 3, (N, 30))
    return found


def blobs():
    found = Blobs.empty(N, 160, 120)
    found.counts[:] = RANDOM.integers(0, 160, N)
    found.counts[2] = 0
    for name in BLOB.names:
        top = 100.0 if name == "range" else 2**32
        found.blobs[name] = RANDOM.uniform(0, top, (N, 160))
    return found


@pytest.mark.parametrize("rows", [range(N), [1, 2, 5], []])
def test_a_batch_of_scans_is_what_each_would_be_alone(rows):
    readings = scans()
    found = ENCODERS["scans"]()(group_of(readings, rows))
    for row, payload in zip(rows, found, strict=True):
        values = messages.decode(Interface.LASER, 1, 1, payload)
        hit = readings.hits[row] >= 0
        expected = told(readings.ranges[row], hit, readings.max_range).astype(np.float32)
        assert np.array_equal(values["ranges"], expected)
        end = np.float32(readings.max_range)
        assert np.array_equal(values["ranges"] < end, hit | (readings.ranges[row] < 8.0999))
        assert (values["max_range"], values["intensity"], values["id"]) == (end, b"", 0)
        assert values["min_angle"] == -values["max_angle"] == np.float32(-1.5)


@pytest.mark.parametrize("rows", [range(N), [1, 2, 5], []])
def test_a_batch_of_blobs_lies_as_the_table_has_it(rows):
    readings = blobs()
    found = ENCODERS["blobs"]()(group_of(readings, rows))
    form = layouts.data(Interface.BLOBFINDER)
    for row, payload in zip(rows, found, strict=True):
        expected = form.rows(1, blobs=int(readings.counts[row]))
        expected["width"], expected["height"] = 160, 120
        for name in BLOB.names:
            expected["blobs"][name] = readings.seen(row)[name]
        assert payload == expected.tobytes()


def test_a_reading_is_encoded_once_for_all_who_read_it_in_a_round():
    asked = []
    group = group_of(scans(), [4, 1])

    def encode(group):
        asked.append(len(group.rows))
        return [b"four", b"one"]

    encoder = GroupEncoder(group, encode)
    assert [encoder.payload(row, 1) for row in (1, 4, 1)] == [b"one", b"four", b"one"]
    assert asked == [2]
    group.rows = np.array([1, 4], np.int64)
    assert encoder.payload(1, 2) == b"four"  # the first now
    assert asked == [2, 2]
