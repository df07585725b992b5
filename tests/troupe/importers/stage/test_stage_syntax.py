"""Stage's syntax: tokens with places, properties, macros, includes; and mistakes at their place."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from troupe.importers.stage.syntax import Entity, read_file
from troupe.importers.stage.tokens import StageError, scan

TYPES = {"model", "position", "ranger", "sensor", "block"}


@pytest.fixture
def read(tmp_path: Path):
    def reader(text: str, **others: str) -> Entity:
        for name, content in others.items():
            (tmp_path / f"{name}.inc").write_text(content)
        path = tmp_path / "a.world"
        path.write_bytes(text.encode())
        return read_file(str(path), TYPES)

    return reader


def values(entity: Entity) -> dict[str, tuple[object, ...]]:
    return {key: found.values for key, found in entity.properties.items()}


def test_properties_are_numbers_strings_and_lists(read) -> None:
    world = read('name "my world" # a comment\nresolution .02 pose [1 -2.5 +3 1e2] list ["a" 4]')
    assert values(world) == {
        "name": ("my world",),
        "resolution": (0.02,),
        "pose": (1.0, -2.5, 3.0, 100.0),
        "list": ("a", 4.0),
    }


def test_several_properties_share_a_line_and_a_value_may_follow_on_the_next(read) -> None:
    world = read("a 1 b 2\nc\n3 d[0] [4 5] e[6 7]")
    assert values(world) == {"a": (1,), "b": (2,), "c": (3,), "d[0]": (4, 5), "e": (6, 7)}


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_are_counted_however_they_end(read, end: str) -> None:
    world = read(end.join(["# one", "a 1", "  model ( )"]))
    assert world.properties["a"].place.line == 2
    assert (world.children[0].place.line, world.children[0].place.column) == (3, 3)


def test_the_last_of_several_values_counts(read) -> None:
    assert values(read("a 1 a 2"))["a"] == (2,)


def test_a_macro_gives_its_properties_and_entities_and_can_be_overridden(read) -> None:
    world = read(
        "define eye ranger ( sensor ( samples 1 ) )\n"
        'define rover position ( color "red" size [1 1 1] eye () )\n'
        'define fast rover ( color "blue" )\n'
        "fast ( size [2 2 2] model ( ) )\nrover ( )"
    )
    fast, rover = world.children
    assert (fast.word, fast.type, fast.macros) == ("fast", "position", ("fast", "rover"))
    assert values(fast) == {"color": ("blue",), "size": (2, 2, 2)}
    assert [child.type for child in fast.children] == ["ranger", "model"]
    assert fast.children[0].children[0].type == "sensor"
    assert values(rover)["color"] == ("red",)
    assert (fast.place.line, fast.properties["color"].place.line) == (4, 3)


def test_what_one_robot_changes_does_not_reach_another_of_the_same_macro(read) -> None:
    one, two = read("define r position ( ranger ( a 1 ) )\nr ( a 1 )\nr ( )").children
    one.children[0].used.add("a")
    assert not two.children[0].used
    assert "a" not in two.properties


def test_an_included_file_stands_where_it_is_named_and_keeps_its_places(read) -> None:
    world = read('a 1\ninclude "two.inc"\nbot ( )', two="define bot position ( b 2 )")
    bot = world.children[0]
    assert values(bot) == {"b": (2,)}
    assert bot.properties["b"].place.file.endswith("two.inc")
    assert bot.place.line == 3


def test_a_file_within_an_included_one_is_found_from_the_world_files_folder(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "deep.inc").write_text("define deep position ( )")
    (tmp_path / "sub" / "first.inc").write_text('include "deep.inc" include "beside.inc"')
    (tmp_path / "sub" / "beside.inc").write_text("define beside deep ( )")
    (tmp_path / "a.world").write_text('include "sub/first.inc" beside ( )')
    assert read_file(str(tmp_path / "a.world"), TYPES).children[0].type == "position"


def test_stagepath_names_more_folders(
    read, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "far.inc").write_text("define far model ( )")
    monkeypatch.setenv("STAGEPATH", f"/nonexistent:{tmp_path / 'elsewhere'}")
    assert read('include "far.inc" far ( )').children[0].type == "model"


MISTAKES = {
    "a 1\n  nam€ 2": (2, 6, "'€'"),
    'name "no end\n': (1, 6, 'closing "'),
    "size 1.2.3": (1, 6, "1.2.3"),
    "size 5m": (1, 6, "5m"),
    "model (\n a 1": (1, 7, "never closed"),
    "pose [1 2": (1, 6, "never closed"),
    "pose [1 two]": (1, 9, "not two"),
    "a b": (1, 3, "a value or ("),
    "a": (1, 1, "the file ends"),
    ") ": (1, 1, "not )"),
    "define bot": (1, 8, "the file ends"),
    "define 3 model ( )": (1, 8, "not 3"),
    "define bot model [1]": (1, 18, "needs ( ... )"),
    "model ( define bot model ( ) )": (1, 9, "within an entity"),
    "a 1\n positon ( )": (2, 2, "did you mean position"),
    "define bot bot ( )\nbot ( )": (1, 8, "defined by itself"),
    "include 3": (1, 1, "file name"),
    'a 1\ninclude "none.inc"': (2, 9, "none.inc"),
    'include "a.world"': (1, 9, "includes itself"),
    "model (" * 70 + ")" * 70: (1, 435, "within each other"),
}


@pytest.mark.parametrize(("text", "expected"), MISTAKES.items(), ids=lambda v: repr(v)[:40])
def test_a_mistake_is_told_with_file_line_and_column(read, text: str, expected) -> None:
    line, column, words = expected
    with pytest.raises(StageError) as caught:
        read(text)
    place = caught.value.place
    assert place is not None
    assert words in caught.value.what
    if column == 435:  # which of the parentheses is one too many is not the point
        return
    assert (place.line, place.column) == (line, column)
    assert re.match(r".*a\.world:\d+:\d+: ", str(caught.value))


def test_a_file_that_asks_for_millions_of_entities_is_refused(read) -> None:
    doubling = "".join(f"define m{n + 1} model ( m{n} ( ) m{n} ( ) )\n" for n in range(17))
    with pytest.raises(StageError, match="more than 100000 entities"):
        read("define m0 model ( )\n" + doubling + "m17 ( )")


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(StageError, match="No such file"):
        read_file(str(tmp_path / "none.world"), TYPES)


WORDS = st.sampled_from(
    ["model", "a[0]", "x.y", "1", "-.5", '"text # here"', "(", ")", "[", "]", "# c", "\n", "\t"]
)


@given(st.lists(WORDS, max_size=30))
def test_tokens_give_back_what_was_written(words: list[str]) -> None:
    text = "".join(f"{word}\n" if word == "# c" else f"{word} " for word in words)
    meant = [word.strip('"') for word in words if word not in ("# c", "\n", "\t")]
    assert [token.text for token in scan(text, "f")] == meant


@given(
    st.text(
        st.characters(exclude_categories=["Cs"]) | st.sampled_from('()[]"\n define 1a'), max_size=80
    )
)
def test_any_text_is_read_or_refused_with_a_place(
    tmp_path_factory: pytest.TempPathFactory, text: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.world"
    path.write_bytes(text.encode())
    told = None
    try:
        read_file(str(path), TYPES)
    except StageError as error:
        told = error
    assert told is None or (told.place is not None and told.place.line >= 1)
