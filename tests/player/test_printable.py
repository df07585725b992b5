"""What others have written, as a terminal may be shown it."""

from __future__ import annotations

import sys
import unicodedata

import pytest

from player.printable import printable, printable_lines
from sim.worldfile.mistakes import Mistake, WorldError


@pytest.mark.parametrize(
    ("line", "safe"),
    [
        ("\x1b[2J\x1b]0;title\x07gone", "\\x1b[2J\\x1b]0;title\\x07gone"),
        ("50 %\r100 %", "50 %\\r100 %"),
        ("\x9b31mred", "\\x9b31mred"),
        ("\u202eesrever", "\\u202eesrever"),
        ("name\udcff.yaml", "name\\udcff.yaml"),  # of a file, in bytes that are no UTF-8
        ("tab\tand\néç, 一, 🤖 stay", "tab\tand\néç, 一, 🤖 stay"),
    ],
)
def test_what_a_terminal_would_obey_is_shown_as_text(line: str, safe: str) -> None:
    assert printable_lines(line) == safe
    assert printable(line) == safe.replace("\t", "\\t").replace("\n", "\\n")


def test_no_control_character_is_left_whichever_it_is() -> None:
    everything = "".join(map(chr, range(sys.maxunicode + 1)))
    left = {unicodedata.category(character) for character in printable(everything)}
    assert left.isdisjoint({"Cc", "Zl", "Zp", "Cs"})
    both_ways = {
        character
        for character in printable(everything)
        if unicodedata.bidirectional(character) in {"RLO", "LRO", "RLE", "LRE", "PDF"}
        or unicodedata.bidirectional(character) in {"RLI", "LRI", "FSI", "PDI"}
    }
    assert not both_ways


def test_a_mistake_is_one_line_that_no_terminal_obeys_wherever_the_world_put_it() -> None:
    evil = "a\x1b[2J\nworld.yaml: ok\u202e"
    mistake = Mistake((evil, 0), f"no {evil}", evil, evil, evil, 1, 2)
    told = str(WorldError([mistake]))
    assert len(told.splitlines()) == 1
    assert told == printable(told)
    assert told.count("a\\x1b[2J\\nworld.yaml: ok\\u202e") == 5
