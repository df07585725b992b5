"""Text becomes a tree of plain values with the place of each; nothing in it can do harm."""

from __future__ import annotations

import pytest

from sim.worldfile.nodes import MappingNode, Mark, Path, mark_of, plain
from sim.worldfile.reader import MOST_DEPTH, Unreadable, read_text


def tree(text: str) -> MappingNode:
    root, mistakes = read_text(text, "f")
    assert mistakes == []
    assert isinstance(root, MappingNode)
    return root


def told(text: str) -> list[str]:
    """All mistakes, also the one after which nothing can be read."""
    try:
        return [str(mistake) for mistake in read_text(text, "f")[1]]
    except Unreadable as error:
        return [str(error.mistake)]


def test_values_are_plain() -> None:
    text = "a: [1, 2.5, x, 'true', \"3\", null]\nb: {c: {d: true}}\ne: |\n  two\n  lines\n"
    assert plain(tree(text)) == {
        "a": (1, 2.5, "x", "true", "3", None),
        "b": {"c": {"d": True}},
        "e": "two\nlines\n",
    }


@pytest.mark.parametrize(
    ("where", "line", "column"),
    [((), 1, 1), (("a",), 1, 4), (("a", 1), 1, 8), (("b", "ü", "d"), 3, 10), (("b", "ü"), 3, 6)],
)
def test_every_value_knows_its_place(where: Path, line: int, column: int) -> None:
    root = tree("a: [1, 2]\nb:\n  ü: {d: 3}\n")
    assert mark_of(root, where) == Mark("f", line, column)


def test_every_key_knows_its_place_and_what_is_missing_is_told_at_the_part_above() -> None:
    root = tree("a: [1, 2]\nb:\n  ü: {d: 3}\n")
    assert mark_of(root, ("b", "ü"), at_key=True) == Mark("f", 3, 3)
    assert mark_of(root, ("b", "ü", "missing")) == Mark("f", 3, 3)
    assert mark_of(root, ("a", 7)) == Mark("f", 1, 1)
    assert mark_of(root, ("missing", "further", 3)) == Mark("f", 1, 1)


def test_columns_count_characters_not_bytes() -> None:
    assert mark_of(tree("äöü: [ß, 1]"), ("äöü", 1)) == Mark("f", 1, 10)


def test_each_duplicate_key_is_told_and_the_first_value_stands() -> None:
    text = "a: 1\nb: {c: 1, c: 2}\na: 3\na: 4\n"
    assert told(text) == [
        "f:2:11: b.c: this key stands twice; first in line 2",
        "f:3:1: a: this key stands twice; first in line 1",
        "f:4:1: a: this key stands twice; first in line 1",
    ]


@pytest.mark.parametrize(
    "text",
    [
        "!!python/object/apply:os.system ['touch /tmp/x']",
        "!!int 5",
        "!mine {a: 1}",
        "! x",
        "!!set {a}",
    ],
)
def test_tags_construct_nothing(text: str) -> None:
    (mistake,) = told(f"a: {text}\n")
    assert mistake.startswith("f:1:4: a: tags have no meaning here")


def test_merge_keys_are_refused_with_a_hint() -> None:
    (mistake,) = told("a: &x {b: 1}\nc:\n  <<: *x\n  d: 2\n")
    assert mistake.startswith("f:3:3: c: merge keys are not part of YAML 1.2")
    assert "`include`" in mistake


def test_a_quoted_merge_key_is_a_key() -> None:
    assert plain(tree('"<<": 1')) == {"<<": 1}


@pytest.mark.parametrize("key", ["1", "true", "null", "1.5", "[a]", "{a: 1}"])
def test_keys_are_text(key: str) -> None:
    (mistake,) = told(f"a:\n  ? {key}\n  : 1\n")
    assert "a key must be text" in mistake


def test_aliases_stand_for_their_value() -> None:
    assert plain(tree("a: &x [1, 2]\nb: [*x, *x]\n")) == {"a": (1, 2), "b": ((1, 2), (1, 2))}


def test_a_billion_laughs_are_refused() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 10)]
    (mistake,) = told("\n".join(lines))
    assert "aliases stand for more than 200000 values" in mistake
    assert mistake.startswith("f:6:")  # 100 000 values to line 5 are still taken


def test_an_alias_of_what_it_stands_in_is_refused() -> None:
    assert told("a: &x [1, *x]\n") == [
        "f:1:11: a.1: an alias of something that it stands in (given: *x)"
    ]


def test_an_alias_of_nothing_is_refused() -> None:
    assert told("a: *x\n") == ["f:1:4: a: an alias of nothing that stands before it (given: *x)"]


@pytest.mark.parametrize(("opening", "closing"), [("[", "]"), ("{a: ", "}"), ("- ", "")])
@pytest.mark.parametrize("depth", [MOST_DEPTH + 1, 3000, 100_000])
def test_deep_nesting_is_refused(opening: str, closing: str, depth: int) -> None:
    (mistake,) = told(opening * depth + "1" + closing * depth)
    assert "levels deep" in mistake or "not YAML" in mistake  # libyaml has a limit of its own


@pytest.mark.parametrize(
    ("text", "place"),
    [("a: [1, 2\nb: 3\n", "f:2:2"), ("a: 'x\n", "f:2:1"), ("a: b: c\n", "f:1:5"),
     ("a: 1\n b: 2\n", "f:2:3"), ("a: @x\n", "f:1:4"), ("%YAML 7.0\n---\na: 1\n", "f:1:1"),
     ("a: \x07\n", "f:1:4"), ("a: 1\nb: x\x00y\n", "f:2:5"), ("\ta: 1\n", "f:1:1")],
)  # fmt: skip
def test_what_is_not_yaml_is_told_with_its_place(text: str, place: str) -> None:
    (mistake,) = told(text)
    assert mistake.startswith(f"{place}: ")
    assert "not YAML" in mistake or "not allowed in YAML" in mistake


def test_a_tab_is_told_as_one() -> None:
    (mistake,) = told("a:\n\tb: 1\n")
    assert "indent with spaces" in mistake


def test_one_document_only() -> None:
    assert told("a: 1\n---\nb: 2\n") == [
        "f:2:1: a second document begins (given: ---; allowed: one document)"
    ]


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing\n", "---\n", "null\n", "~"])
def test_nothing_is_no_tree(text: str) -> None:
    assert read_text(text, "f") == (None, [])


def test_an_endless_integer_is_a_mistake_like_others() -> None:
    assert told(f"a: {'9' * 5000}\n") == [
        "f:1:4: a: an integer of 5000 characters is too large for anything here"
    ]
