"""Colours by name."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sensors.colors import X11, format_color, parse_color


def test_names_are_x11s_not_those_of_web_pages():
    # The four in which X11's table and CSS differ, and a few of everywhere.
    assert parse_color("green") == 0x00FF00
    assert parse_color("gray") == 0xBEBEBE
    assert parse_color("maroon") == 0xB03060
    assert parse_color("purple") == 0xA020F0
    assert parse_color("red") == 0xFF0000
    assert parse_color("DarkSlateGray") == parse_color("dark slate grey") == 0x2F4F4F
    assert parse_color("tomato3") == 0xCD4F39
    assert parse_color("gray50") == 0x7F7F7F
    assert parse_color("Grey51") == 0x828282
    assert parse_color("white") == parse_color("gray100") == 0xFFFFFF


@given(st.integers(0, 0xFFFFFF))
def test_every_colour_is_written_and_read_back(color):
    assert parse_color(format_color(color)) == color
    assert parse_color(format_color(color).upper()) == color


@pytest.mark.parametrize("text", ["", "#12345", "#1234567", "#12345g", "123456", "reed", "#-12345"])
def test_what_is_no_colour_is_refused(text):
    with pytest.raises(ValueError, match="colour"):
        parse_color(text)


def test_a_misspelt_name_is_suggested():
    with pytest.raises(ValueError, match=r"did you mean .*green"):
        parse_color("gren")


def test_the_table_is_whole():
    assert len(X11) > 650
    assert all(0 <= color <= 0xFFFFFF for color in X11.values())
    assert all(name == name.lower() and " " not in name for name in X11)
