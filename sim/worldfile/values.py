"""The kinds of value that world files are made of: numbers with limits, poses, colours, names."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from sensors.colors import parse_color
from sensors.eyes import EYES, Eye


class Part(BaseModel):
    """Base of everything in a world file: unknown keys are mistakes, values never change.

    A part's validator is built when it is first asked for: most are asked as parts of a world only.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, defer_build=True)


def wrong(
    what: str,
    *,
    given: object = None,
    allowed: str | None = None,
    at: tuple[str | int, ...] = (),
    uses: tuple[str, ...] = (),
    at_key: bool = False,
) -> PydanticCustomError:
    """The error that a validator raises.

    `at` leads from the validated value to the culprit. `uses` names keys of the validated part
    that the claim rests on: where one of them is wrong itself, the claim is not made. With
    `at_key` the culprit is a key, not its value.
    """
    context = {
        "what": what,
        "given": given,
        "allowed": allowed,
        "at": at,
        "uses": uses,
        "at_key": at_key,
    }
    return PydanticCustomError("world", "{what}", context)


def _tuple_of(names: str) -> BeforeValidator:
    wanted = len(names.split(", "))

    def check(value: Any) -> Any:
        if not isinstance(value, tuple) or len(value) != wanted:
            raise wrong(f"must be a list of {wanted} numbers", given=value, allowed=f"[{names}]")
        return value

    return BeforeValidator(check)


def _color(value: Any) -> int:
    if value is None:
        raise wrong(
            "must be a colour; an unquoted # begins a comment in YAML",
            given=None,
            allowed='an X11 name such as red, or "#rrggbb" in quotes',
        )
    if not isinstance(value, str):
        raise wrong(
            "must be a colour", given=value, allowed='an X11 name such as red, or "#rrggbb"'
        )
    try:
        return parse_color(value)
    except ValueError as error:
        raise wrong(
            str(error), given=value, allowed='an X11 name such as red, or "#rrggbb"'
        ) from None


def _file(value: Any) -> Any:
    if not isinstance(value, str) or not value or "\0" in value:
        raise wrong("must be a file's name", given=value, allowed="text")
    return Path(value)


NAME = r"^[A-Za-z_][A-Za-z0-9_.-]*$"
"""Names of robots, models and doors: they stand in file names, dotted paths and on the wire."""


def _name(value: Any) -> Any:
    if not isinstance(value, str) or len(value) > 60 or not re.fullmatch(NAME, value):
        raise wrong(
            "cannot be a name",
            given=value,
            allowed="a letter, then letters, digits and _ . - (at most 60 in all)",
        )
    return value


def is_host(text: str) -> bool:
    """Whether a text can be the name or the address of a host: labels of 1 to 63 characters."""
    try:
        encoded = text.encode("idna")
    except UnicodeError:
        return False
    return 0 < len(encoded) <= 253 and text.isprintable() and " " not in text


def _host(value: Any) -> Any:
    if not isinstance(value, str) or not is_host(value):
        allowed = "an address such as 127.0.0.1 or ::1, or a host's name"
        raise wrong("cannot be a host", given=value, allowed=allowed)
    return value


def _not_tiny(value: float) -> float:
    if value < SMALLEST:
        raise wrong("is too small", given=value, allowed=f"{SMALLEST:g} or more")
    return value


LARGEST = 1e9
SMALLEST = 1e-9
"""Beyond these a double has no digits left for what is between: squares and inverses overflow."""

Positive = Annotated[float, Field(gt=0, le=LARGEST, allow_inf_nan=False), AfterValidator(_not_tiny)]
NonNegative = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False)]
Finite = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
COLOR = "^(#[0-9a-fA-F]{6}|[A-Za-z][A-Za-z0-9 ]*)$"
"""A colour's spelling; whether X11 has the name is not said by the pattern."""


def _seen_by(value: Any) -> Any:
    if value is not None and not isinstance(value, tuple):
        raise wrong("must be a list", given=value, allowed=f"of {', '.join(EYES)}")
    return value


SeenBy = Annotated[tuple[Eye, ...] | None, BeforeValidator(_seen_by)]
"""The kinds of sensor that see a thing; None: all."""
Point = Annotated[tuple[Finite, Finite], _tuple_of("x, y")]
Size = Annotated[tuple[Positive, Positive], _tuple_of("width, height")]
Pose = Annotated[tuple[Finite, Finite, Finite], _tuple_of("x, y, heading in degrees")]
"""x, y in metres, heading in degrees counter-clockwise from the x axis."""
Color = Annotated[
    int,
    BeforeValidator(_color),
    WithJsonSchema({"type": "string", "format": "color", "pattern": COLOR}),
]
"""0xRRGGBB; written as an X11 name or `#rrggbb`."""
RANDOM = -1
"""In place of a colour: one is drawn, by the run's seed and the thing's name."""


def _body_color(value: Any) -> int:
    return RANDOM if value == "random" else _color(value)


BodyColor = Annotated[
    int,
    BeforeValidator(_body_color),
    WithJsonSchema({"type": "string", "format": "color", "pattern": COLOR}),
]
"""A colour, or `random`."""
FileName = Annotated[
    Path, BeforeValidator(_file), WithJsonSchema({"type": "string", "minLength": 1})
]
Host = Annotated[str, BeforeValidator(_host), WithJsonSchema({"type": "string", "minLength": 1})]
Name = Annotated[
    str,
    BeforeValidator(_name),
    WithJsonSchema({"type": "string", "pattern": NAME, "maxLength": 60}),
]
