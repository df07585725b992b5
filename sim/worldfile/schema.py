"""The schema of world files: every key, its unit, its default and what is allowed."""

from __future__ import annotations

from math import ceil
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema, model_validator

from sim.worldfile.dividing import MOST_STEPS, divides, step_within
from sim.worldfile.models import Drive, Gripper, Model, OdometryNoise, Sprayer
from sim.worldfile.options import checked_args
from sim.worldfile.shapes import Body, Box, Circle, ConvexPolygon, Obstacle, Polygon
from sim.worldfile.values import (
    LARGEST,
    SMALLEST,
    Color,
    FileName,
    Finite,
    Host,
    Name,
    NonNegative,
    Part,
    Point,
    Pose,
    Positive,
    SeenBy,
    Size,
    wrong,
)

__all__ = [
    "Body",
    "Boundary",
    "Box",
    "Circle",
    "Clock",
    "Color",
    "Controller",
    "Door",
    "Drive",
    "Floor",
    "Gripper",
    "Log",
    "Map",
    "Model",
    "Obstacle",
    "OdometryNoise",
    "Part",
    "PlacementRule",
    "Player",
    "Point",
    "Polygon",
    "Pose",
    "Robots",
    "Size",
    "Sprayer",
    "Video",
    "World",
]

RED = 0xFF0000
Side = Annotated[int, Field(ge=64, le=4096, multiple_of=2)]
"""Pixels of a frame's width or height."""
LARGEST_STEP = 0.02
"""Seconds of physics at once unless a world says otherwise."""


class Clock(Part):
    """How time is cut up."""

    interval: Positive = Field(default=0.1, description="s between readings")
    physics_step: Positive = Field(
        default=LARGEST_STEP,
        description="s; divides `interval`. Default: the longest up to 0.02 that does",
    )

    @model_validator(mode="before")
    @classmethod
    def _step_that_divides(cls, data: Any) -> Any:
        if isinstance(data, dict) and "physics_step" not in data:
            interval = data.get("interval", 0.1)
            if isinstance(interval, int | float) and SMALLEST <= interval < 1e6:
                steps = max(1, ceil(interval / LARGEST_STEP - 1e-9))
                return {**data, "physics_step": interval / steps}
        return data

    @model_validator(mode="after")
    def _step_divides(self) -> Self:
        shortest = self.interval / MOST_STEPS
        if not divides(self.physics_step, self.interval):
            near = step_within(self.interval, max(self.physics_step, shortest))
            raise wrong(
                "does not divide `interval`",
                given=self.physics_step,
                allowed=f"{self.interval:g} over a whole number, such as {near}",
                at=("physics_step",),
                uses=("interval",),
            )
        if round(self.interval / self.physics_step) > MOST_STEPS:
            raise wrong(
                "is too short for `interval`",
                given=self.physics_step,
                allowed=f"{shortest:g} or more: at most {MOST_STEPS} steps in an interval",
                at=("physics_step",),
                uses=("interval",),
            )
        return self


class Boundary(Part):
    """Walls around the world, outside of `size`."""

    color: Color = Field(default=RED, description="X11 name or #rrggbb")
    thickness: Positive = Field(default=0.2, description="m")
    height: Positive = Field(default=1.0, description="m; what a camera sees")
    friction: NonNegative = Field(
        default=0.5, description="Coulomb's coefficient where bodies touch it"
    )
    shape: Literal["size", "region"] = Field(
        default="size",
        description="whether they stand around `size` or along the edges of `region`",
    )


class Floor(Part):
    """The layer that sprayers paint."""

    resolution: Positive = Field(default=0.05, description="m per cell of the paint layer")


class Map(Part):
    """Walls from a picture or a text."""

    file: FileName = Field(
        description="a picture (dark is wall), or a text (# wall, . free, S door)"
    )
    resolution: Positive | None = Field(default=None, description="m per pixel of a picture")
    cell: Positive | None = Field(default=None, description="m per character of a text")
    color: Color = Field(default=RED, description="X11 name or #rrggbb")
    height: Positive = Field(default=1.0, description="m; what a camera sees")
    friction: NonNegative = Field(
        default=0.5, description="Coulomb's coefficient where bodies touch it"
    )
    solid: bool = Field(default=True, description="false: its walls stop nobody")
    seen_by: SeenBy = Field(
        default=None, description="the kinds of sensor that see its walls; [] for none"
    )

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if self.resolution is not None and self.cell is not None:
            raise wrong(
                "a map is a picture with `resolution` or a text with `cell`, not both",
                at=("cell",),
            )
        if self.resolution is None and self.cell is None:
            text = self.file.suffix.lower() in ("", ".txt", ".map")
            raise wrong(
                "a text map needs `cell`, metres per character"
                if text
                else "an image map needs `resolution`, metres per pixel",
                given=str(self.file),
                uses=("resolution", "cell", "file"),
            )
        return self


class PlacementRule(Part):
    """How the robots of an entry are put down at random."""

    same_y: bool = Field(
        default=False, description="true: all robots of the entry on one line, same y"
    )
    margin: NonNegative = Field(default=0.1, description="m kept free around each robot")
    in_turn: bool = Field(
        default=False,
        description="true: the robots get the `headings` in turn, from any on, instead of drawing",
    )


def _placement(value: Any) -> Any:
    if isinstance(value, str):
        if value != "random":
            raise wrong(
                "unknown placement", given=value, allowed="random, or {same_y: ..., margin: ...}"
            )
        return {}
    return value


class Robots(Part):
    """One entry of `robots`: a robot with a pose, or `count` robots placed at random."""

    model: str = Field(description="a name under `models`")
    name: Name | None = Field(
        default=None,
        description="default: the model's name and a number; with `count`, name1, name2, ...",
    )
    pose: Pose | None = Field(default=None, description="x, y in m and heading in degrees")
    count: Annotated[int, Field(ge=1, le=100_000)] = Field(
        default=1, description="how many; more than one need `placement`"
    )
    placement: Annotated[PlacementRule | None, BeforeValidator(_placement)] = Field(
        default=None,
        description="random, or a rule; where they start then depends on the seed alone",
    )
    headings: Annotated[tuple[Finite, ...], Field(min_length=1)] | None = Field(
        default=None, description="degrees; a set to draw from. Default: any heading"
    )
    controller: str | None = Field(
        default=None,
        description="a name under `controllers`, or of a program that comes with Troupe; "
        "null: the robot stands still",
    )

    @model_validator(mode="after")
    def _pose_or_placement(self) -> Self:
        if self.pose is None and self.placement is None:
            raise wrong("a robot needs `pose`, or `placement: random`", uses=("pose", "placement"))
        if self.pose is not None and self.placement is not None:
            raise wrong("a robot has `pose` or `placement`, not both", at=("placement",))
        if self.pose is not None and self.count > 1:
            raise wrong(
                "several robots cannot share a pose",
                given=f"count: {self.count}",
                allowed="`placement: random`, or an entry with a pose for each",
                at=("count",),
            )
        if self.pose is not None and self.headings is not None:
            raise wrong(
                "`headings` goes with `placement`; a pose has its heading", at=("headings",)
            )
        if self.placement is not None and self.placement.in_turn and self.headings is None:
            raise wrong(
                "`in_turn` needs `headings` to give out",
                at=("placement", "in_turn"),
                uses=("headings", "placement"),
            )
        return self


def _door_place(value: Any) -> Any:
    if value == "S":
        return value
    if (
        isinstance(value, tuple)
        and len(value) == 2
        and all(type(v) in (int, float) and abs(v) < float("inf") for v in value)
    ):
        return (float(value[0]), float(value[1]))
    raise wrong("must be a place", given=value, allowed="S (the map's door), or [x, y] in m")


class Door(Part):
    """A cell through which robots enter one by one."""

    name: Name = Field(description="its robots are called name1, name2, ...")
    at: Annotated[
        str | tuple[float, float],
        PlainValidator(_door_place),
        WithJsonSchema(
            {
                "anyOf": [
                    {"const": "S"},
                    {
                        "type": "array",
                        "prefixItems": [{"type": "number"}, {"type": "number"}],
                        "minItems": 2,
                        "maxItems": 2,
                    },
                ]
            }
        ),
    ] = Field(description="S: the text map's door; or [x, y], the cell's centre in m")
    model: str = Field(description="a name under `models`")
    heading: Finite = Field(default=0.0, description="degrees; how its robots look when they enter")
    period: Positive = Field(description="s; step n ends at n times this, and so may a robot enter")
    controller: str | None = Field(default=None, description="as for robots")


class Controller(Part):
    """A program that drives robots: exactly one of `program`, `command` and `external: true`."""

    program: Annotated[str, Field(min_length=1)] | None = Field(
        default=None, description="one of Troupe's by name, or a Python file such as ./mine.py"
    )
    command: Annotated[tuple[str, ...], Field(min_length=1)] | None = Field(
        default=None,
        description="an executable and its arguments, over TCP; {port} stands for the port",
    )
    external: bool = Field(default=False, description="true: wait for a Player client to connect")
    args: Annotated[dict[str, Any], PlainValidator(checked_args)] = Field(
        default={}, description="command-line options: `robots: 4` is `--robots 4`"
    )

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        given = [key for key in ("program", "command", "external") if getattr(self, key)]
        if len(given) != 1:
            raise wrong(
                "a controller is one of three kinds",
                given=" and ".join(given) or "none of them",
                uses=("program", "command", "external"),
                allowed="program, command, or external: true",
            )
        if self.external and self.args:
            raise wrong("nobody reads the args of an external controller", at=("args",))
        return self


class Player(Part):
    """How Player's clients reach the robots."""

    host: Host = Field(default="127.0.0.1", description="address to listen on")
    port: Annotated[int, Field(ge=0, le=65535)] | None = Field(
        default=None, description="the first robot's port; null: no port is open; 0: any free one"
    )
    layout: Literal["per_robot", "shared"] = Field(
        default="per_robot",
        description="a port for each robot, or one port that serves all by index",
    )
    clock: Literal["all", "any", "free"] = Field(
        default="all",
        description="whether a tick waits for every robot's client, for any, or, `free`, for none: "
        "then the world runs on by itself in real time",
    )


class Video(Part):
    """How videos and pictures of this world are made unless the command line says otherwise."""

    fps: Annotated[float, Field(ge=1, le=240)] = Field(
        default=25.0, description="frames per second of video"
    )
    speed: Annotated[float, Field(ge=0.01, le=1e6)] = Field(
        default=10.0, description="simulated s per second of video"
    )
    size: tuple[Side, Side] | None = Field(
        default=None, description="width and height in pixels, even; null: the world's shape"
    )
    show: tuple[Literal["fans", "names", "trails", "speech", "blobs"], ...] = Field(
        default=("fans", "names", "trails", "speech"),
        description="what shows besides bodies and paint",
    )


def _log(value: Any) -> Any:
    return {"file": value} if isinstance(value, str) else value


def _names(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


class Log(Part):
    """The log of every run of the world that is not given another."""

    file: FileName = Field(description="*.mcap; a relative name starts at the current folder")
    sensors: Annotated[tuple[str, ...], BeforeValidator(_names)] = Field(
        default=(),
        description="whose readings are kept as well: all, or types such as laser, blobfinder, "
        "odometry, commands",
    )


def _origin(value: Any) -> Any:
    if value is None or value == "center":
        return value
    if (
        isinstance(value, tuple)
        and len(value) == 2
        and all(type(v) in (int, float) and abs(v) <= LARGEST for v in value)
    ):
        return (float(value[0]), float(value[1]))
    raise wrong("must be a place", given=value, allowed="[x, y] in m, or center")


class World(Part):
    """A world: a floor, what stands on it, robots, and the programs that drive them."""

    name: str | None = Field(default=None, description="for people")
    size: Size | None = Field(
        default=None, description="width and height, m; required unless it follows from a map"
    )
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = Field(
        default=1, description="all that is random follows from it"
    )
    duration: Positive = Field(default=600.0, description="simulated s at most")
    until: Literal["controllers", "duration"] = Field(
        default="controllers",
        description="when a run is complete: when all controllers have finished, or after "
        "`duration`",
    )
    clock: Clock = Field(default=Clock(), description="how time is cut up")
    boundary: Boundary | None = Field(
        default=Boundary(), description="walls around the world; null: none"
    )
    origin: Annotated[tuple[float, float] | Literal["center"] | None, BeforeValidator(_origin)] = (
        Field(
            default=None,
            description="where coordinates count from: [x, y] in m from the lower left corner, or "
            "center; default: that corner",
        )
    )
    region: ConvexPolygon | None = Field(
        default=None,
        description="convex polygon [x, y], m: where robots are placed and coverage is counted",
    )
    floor: Floor = Field(default=Floor(), description="the layer that sprayers paint")
    map: Map | None = Field(default=None, description="walls from a picture or a text")
    obstacles: tuple[Obstacle, ...] = Field(default=(), description="what else stands there")
    models: dict[Name, Model] = Field(default={}, description="kinds of robot, by name")
    robots: tuple[Robots, ...] = Field(
        default=(), description="the robots that are there from the start"
    )
    doors: tuple[Door, ...] = Field(
        default=(), description="doors through which robots come in one by one"
    )
    controllers: dict[str, Controller] = Field(
        default={}, description="programs that drive robots, by name"
    )
    player: Player = Field(default=Player(), description="how Player's clients reach the robots")
    video: Video = Field(default=Video(), description="how videos and pictures are made")
    log: Annotated[Log | None, BeforeValidator(_log)] = Field(
        default=None, description="a file, or its file and sensors: where runs are kept"
    )

    @model_validator(mode="after")
    def _has_size_and_region(self) -> Self:
        if self.size is None and self.map is None:
            raise wrong(
                "the world needs `size`, or a map that it follows from",
                at=("size",),
                allowed="[width, height] in m",
                uses=("map",),
            )
        if self.boundary is not None and self.boundary.shape == "region" and self.region is None:
            raise wrong(
                "there is no region",
                given="region",
                allowed="size, or a region in the world",
                at=("boundary", "shape"),
                uses=("region",),
            )
        return self
