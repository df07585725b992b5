"""Regions that a text stands for, and runs on them as a sweep calls them."""

import numpy as np
import pytest

from gridworld.generators import comb, random_region
from gridworld.grid import simulate
from gridworld.named import named
from gridworld.regions import RegionError
from troupe.grid import disperse
from troupe.sweep.asked import asked_plan
from troupe.usage import UsageError


def test_texts_stand_for_regions():
    assert named("4x3", 0).free.shape == (3, 4)
    assert named("comb 6", 0).to_text() == comb(6).to_text()
    assert named("comb", 0).to_text() == comb(None).to_text()
    assert named("ring 5 1", 0).cells == 16
    drawn = random_region("rooms", np.random.default_rng(7), 10)
    assert named("rooms 10", 7).to_text() == drawn.to_text()
    assert named("any", 3).to_text() == named("any", 3).to_text() != named("any", 8).to_text()
    assert named("flat", 0) is None


@pytest.mark.parametrize("text", ["comb 1", "comb x", "ring 5", "rooms", "any 3", "0x4"])
def test_numbers_that_make_no_region_are_told(text):
    with pytest.raises(RegionError):
        named(text, 0)


def test_a_run_is_that_of_the_simulator():
    figures = disperse(4, "6x5", door="0,4", rule="dflf")
    region = named("6x5", 4).with_doors([(0, 4)])
    assert figures == simulate(region, "dflf", seed=4).figures()
    assert disperse(0, "flat")["total_travel"] == 5907
    assert disperse(0, "5x7", door="best")["max_distance"] == 5
    assert disperse(0, "any", doors=3)["entered"] > 0


@pytest.mark.parametrize(
    "asked",
    [
        {"region": "nowhere"},
        {"region": "4x3"},
        {"region": "4x3", "door": "9,9"},
        {"region": "4x3", "door": "1;1"},
        {"region": "4x3", "doors": 13},
        {"region": "ring 5 1", "door": "0,0"},
    ],
)
def test_what_cannot_be_is_told(asked):
    with pytest.raises((RegionError, UsageError)):
        disperse(0, **asked)


def test_a_sweep_finds_what_cannot_be_before_the_first_run():
    settings = ("region=4x3,flat,nowhere,comb 1", "rule=fcdf", "q=1", "doors=0", "conflict=fight")
    with pytest.raises(UsageError) as found:
        asked_plan(
            ["troupe.grid:disperse"], seeds="0:2", settings=settings, table=None, duration=None,
            each=(), about={},
        )  # fmt: skip
    told = str(found.value)
    for said in ("nowhere: No such file", "comb 1", "mean fcdfs?", "below 1", "1 or more", "stay"):
        assert said in told
