"""Plain scalars are read by YAML 1.2's core schema."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.worldfile.scalars import core_scalar


@pytest.mark.parametrize("text", ["", "~", "null", "Null", "NULL"])
def test_nulls(text: str) -> None:
    assert core_scalar(text) is None


@pytest.mark.parametrize("text", ["true", "True", "TRUE", "false", "False", "FALSE"])
def test_truths(text: str) -> None:
    assert core_scalar(text) is (text.lower() == "true")


@pytest.mark.parametrize(
    "text",
    ["off", "on", "no", "yes", "y", "N", "tRUE", "nULL", "1:30", "190:20:30", "1_000", "0b11",
     "0o8", "0xG", "+0x1", "-0o7", "1e", "e3", ".", "+", "-", "--1", "1.2.3", "inf", "nan", "+.nan",
     ".Inf.", "2001-12-14", "1 000", "0 ", "=", "<<", "١٢"],
)  # fmt: skip
def test_what_the_core_schema_does_not_name_is_text(text: str) -> None:
    assert core_scalar(text) == text


@pytest.mark.parametrize(
    ("text", "number"),
    [("0", 0), ("-0", 0), ("+12", 12), ("007", 7), ("0o17", 15), ("0x1F", 31), ("0xff", 255),
     ("1e-3", 1e-3), ("1E3", 1e3), ("1.", 1.0), (".5", 0.5), ("-.5e+1", -5.0), ("685.230_15", None),
     (".inf", math.inf), ("-.INF", -math.inf), ("+.Inf", math.inf), ("12e03", 12000.0)],
)  # fmt: skip
def test_numbers(text: str, number: float | None) -> None:
    found = core_scalar(text)
    if number is None:
        assert found == text
    else:
        assert found == number
        assert type(found) is type(number)


def test_not_a_number_is_one() -> None:
    for text in (".nan", ".NaN", ".NAN"):
        found = core_scalar(text)
        assert isinstance(found, float)
        assert math.isnan(found)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_float_that_python_writes_is_read_back(value: float) -> None:
    assert core_scalar(repr(value)) == value


@given(st.integers())
def test_every_integer_is_read_back(value: int) -> None:
    found = core_scalar(str(value))
    assert found == value
    assert isinstance(found, int)


def test_an_endless_integer_is_refused_before_python_refuses_it() -> None:
    with pytest.raises(ValueError, match="5000 characters"):
        core_scalar("9" * 5000)
