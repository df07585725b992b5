"""What the settings of all sensors have in common: strict numbers with units, and a mount pose."""

import math
from functools import cached_property
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema

from sensors.colors import parse_color


def _color(value: object) -> object:
    if isinstance(value, str):
        return parse_color(value)
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= 0xFFFFFF:
        return value
    raise ValueError("a colour is an X11 name or #rrggbb")


Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number: no text, no true or false."""
Count = Annotated[int, Field(strict=True)]
"""A whole number: no 3.0, no text, no true or false."""
Pose = tuple[Number, Number, Number]
"""x, y in metres and heading in degrees, as in world files."""
Housing = tuple[Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0)], ...]
"""Length and width, m."""
Color = Annotated[
    int, BeforeValidator(_color), WithJsonSchema({"type": "string", "format": "color"})
]
"""0xRRGGBB, written as an X11 name or `#rrggbb`."""


def check_min_range(min_range: float, max_range: float) -> None:
    """Raises ValueError where a sensor could measure nothing."""
    if min_range >= max_range:
        raise ValueError(f"min_range must be below range ({min_range:g} and {max_range:g} given)")


def housing() -> Any:
    """The size of a range finder's housing: something that clients may ask for."""
    return setting(
        (0.02, 0.02),
        min_length=2,
        max_length=2,
        unit="m, m",
        description="its length and width: what clients are told; nothing else depends on it",
    )


def setting(default: Any = ..., *, unit: str, description: str, **limits: Any) -> Any:
    """A field of a sensor's settings, with its unit, a description, and limits (gt, ge, le ...)."""
    return Field(default, description=description, json_schema_extra={"unit": unit}, **limits)


class SensorSettings(BaseModel):
    """What a world file may say about a sensor; angles in degrees, as there.

    Settings are frozen, compare by value and can be hashed: robots whose sensors have equal
    settings are sensed in one batch. Lists are therefore tuples.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    pose: Pose = setting(
        (0.0, 0.0, 0.0),
        unit="m, m, deg",
        description="where the sensor sits on its robot, and where it looks",
    )
    z: Number | None = setting(
        None,
        unit="m",
        description="how high it sits: it sees over what ends lower and under what begins higher; "
        "null: it sees things of all heights",
    )

    @cached_property
    def mount(self) -> tuple[float, float, float]:
        """The pose on the robot: x, y in metres, heading in radians."""
        x, y, heading = self.pose
        return x, y, math.radians(heading)
