"""What a sweep is asked for: seeds, settings, samplers, tables and sweep.yaml."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from troupe.sweep.samplers import Sampler, draw, multiplied, sampler_of
from troupe.sweep.seeds import Unusable, parse_seeds, written
from troupe.sweep.spec import Spec, combinations, parse_setting
from troupe.sweep.specfile import is_sweep_file, read_sweep_file, read_table
from troupe.usage import UsageError


def test_a_range_of_seeds_ends_before_its_end() -> None:
    assert parse_seeds("0:4") == [0, 1, 2, 3]
    assert parse_seeds("5, 0:10:5,7:9") == [5, 0, 7, 8]


@pytest.mark.parametrize(
    "text",
    ["", "a", "3:3", "5:2", "-1", "0:5:0", "1:2:3:4", f"{1 << 63}", f"0:{10**30}", "9" * 5000],
)
def test_what_holds_no_seed_is_a_mistake(text: str) -> None:
    with pytest.raises(Unusable, match="--seeds"):
        parse_seeds(text)


def test_how_many_seeds_there_may_be_is_told() -> None:
    with pytest.raises(Unusable, match="at most 10000000 seeds"):
        parse_seeds("0:99999999")


@given(st.lists(st.integers(0, 40), min_size=1, unique=True))
def test_seeds_are_read_as_they_are_written(seeds: list[int]) -> None:
    assert parse_seeds(written(seeds)) == seeds


def test_commas_separate_values_but_not_within_brackets() -> None:
    assert parse_setting("a.b=1,0.5,x") == ("a.b", Sampler("values", (1, 0.5, "x")))
    assert parse_setting("size=[2,3],[4,5]")[1].of == ((2, 3), (4, 5))
    assert parse_setting("c={a: 1, b: 2}")[1].of == ({"a": 1, "b": 2},)
    assert parse_setting("robots.0.controller=null,wander")[1].of == (None, "wander")


@pytest.mark.parametrize("text", ["a", "=1", "a..b=1", "a=", "a=[1", "a=1,]"])
def test_a_setting_that_is_none_is_a_mistake(text: str) -> None:
    with pytest.raises(Unusable, match="--set"):
        parse_setting(text)


def test_parameters_are_multiplied_in_their_order() -> None:
    spec = Spec(("w",), (1,), dict([parse_setting("a=1,2"), parse_setting("b=3,4")]))
    found = [tuple(one.settings.values()) for one in combinations(spec)]
    assert found == [(1, 3), (1, 4), (2, 3), (2, 4)]


def test_every_multiplied_value_has_the_same_samples() -> None:
    parameters = {"a": Sampler("values", (1, 2)), "b": Sampler("uniform", (0.0, 1.0))}
    found = combinations(Spec(("w",), (1,), parameters, samples=3))
    drawn = {a: [o.settings["b"] for o in found if o.settings["a"] == a] for a in (1, 2)}
    assert drawn[1] == drawn[2]
    assert len(set(drawn[1])) == 3


def test_another_parameter_changes_no_draw() -> None:
    one = Sampler("normal", (0.0, 1.0))
    alone = combinations(Spec(("w",), (1,), {"a": one}, samples=4))
    beside = combinations(Spec(("w",), (1,), {"z": one, "a": one}, samples=4))
    assert [o.settings["a"] for o in alone] == [o.settings["a"] for o in beside]


@given(st.integers(0, 2**64), st.integers(0, 1000), st.integers(-5, 5), st.integers(0, 5))
def test_draws_are_within_their_bounds(seed: int, sample: int, low: int, more: int) -> None:
    whole = draw(Sampler("integers", (low, low + more)), "a", seed, sample)
    assert isinstance(whole, int)
    assert low <= whole <= low + more
    assert low <= draw(Sampler("uniform", (low, low + more)), "a", seed, sample) <= low + more
    assert draw(Sampler("choice", ("x", "y")), "a", seed, sample) in ("x", "y")


def test_a_grid_has_both_its_ends() -> None:
    assert multiplied(sampler_of({"grid": (0.0, 1.0, 5)})) == [0.0, 0.25, 0.5, 0.75, 1.0]


SWEEP = """\
worlds: [wander]
seeds: 0:3
samples: 2
sampling_seed: 7
duration: 5
parameters:
  clock.interval: [0.1, 0.05]
  models.rover.drive.max_speed: {uniform: [0.1, 0.4]}
"""


def test_a_file_describes_a_sweep(tmp_path: Path) -> None:
    path = tmp_path / "sweep.yaml"
    path.write_text(SWEEP)
    assert is_sweep_file(str(path))
    found = read_sweep_file(path)
    assert (found.worlds, found.seeds, found.samples, found.duration) == (
        ("wander",),
        (0, 1, 2),
        2,
        5,
    )
    assert found.parameters["models.rover.drive.max_speed"].drawn


def test_a_world_is_no_sweep(tmp_path: Path) -> None:
    (tmp_path / "world.yaml").write_text("size: [3, 3]\n")
    assert not is_sweep_file(str(tmp_path / "world.yaml"))
    assert not is_sweep_file("wander")


def test_all_mistakes_of_a_sweep_file_are_told_with_their_places(tmp_path: Path) -> None:
    path = tmp_path / "sweep.yaml"
    path.write_text(
        "worlds: [wander]\nseed: 3\nseeds: 5:5\nparameters:\n"
        "  a: {unifrom: [1, 2]}\n  b: {uniform: [2, 1]}\n  c: {grid: [0, 1, 1]}\n"
    )
    with pytest.raises(Unusable) as found:
        read_sweep_file(path)
    places = [(one.line, ".".join(map(str, one.where))) for one in found.value.mistakes]
    assert places == [(2, "seed"), (3, "seeds"), (5, "parameters.a"), (6, "parameters.b"),
                      (7, "parameters.c")]  # fmt: skip
    assert "did you mean uniform?" in str(found.value)


def test_the_rows_of_a_table_are_settings(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text('world,seed,a.b,size\nwander,1,0.5,"[1, 2]"\n,2:4,,x\n\n')
    first, second = read_table(path)
    assert (first.world, first.seeds, first.settings) == (
        "wander",
        (1,),
        {"a.b": 0.5, "size": (1, 2)},
    )
    assert (second.world, second.seeds, second.settings) == (None, (2, 3), {"size": "x"})


def test_all_mistakes_of_a_table_are_told_with_their_lines(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text("seed,a\nx,1\n1,2,3\n1,[\n")
    with pytest.raises(Unusable) as found:
        read_table(path)
    assert [one.line for one in found.value.mistakes] == [2, 3, 4]


def test_the_seed_is_no_parameter() -> None:
    with pytest.raises(Unusable, match="--seeds"):
        combinations(Spec(("w",), (1,), dict([parse_setting("seed=1,2")])))


def test_a_setting_stands_in_a_table_or_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("a\n1\n")
    rows = read_table(tmp_path / "rows.csv")
    with pytest.raises(Unusable, match="column of the table"):
        combinations(Spec(("w",), (1,), dict([parse_setting("a=1")]), rows))
    with pytest.raises((Unusable, UsageError), match="no world"):
        combinations(Spec((), (1,), {}, rows))
