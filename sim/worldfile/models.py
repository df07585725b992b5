"""Models of robots in world files: a body, a drive, sensors and actuators."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from sim.worldfile.shapes import Body
from sim.worldfile.values import NonNegative, Part, Point, Pose, Positive, Size, wrong


class Drive(Part):
    """What moves a robot, and its limits."""

    kind: Literal["differential", "omnidirectional", "car"] = Field(
        default="differential",
        description="differential turns on the spot, omnidirectional also moves sideways, "
        "car steers",
    )
    max_speed: Positive = Field(default=0.5, description="m/s")
    max_turn_rate: Positive = Field(default=90.0, description="degrees/s")
    max_acceleration: Positive = Field(default=2.0, description="m/s2")
    max_turn_acceleration: Positive = Field(default=360.0, description="degrees/s2")
    max_force: Positive = Field(default=100.0, description="N; a robot that meets more stalls")
    max_torque: Positive = Field(default=20.0, description="N m")
    wheelbase: Positive | None = Field(
        default=None, description="m between the axles; car only, and there required"
    )
    max_steering: Annotated[float, Field(gt=0, lt=90, allow_inf_nan=False)] | None = Field(
        default=None, description="degrees to either side, below 90; car only, and there required"
    )

    @model_validator(mode="after")
    def _car_has_axles(self) -> Self:
        for key in ("wheelbase", "max_steering"):
            value = getattr(self, key)
            if self.kind == "car" and value is None:
                raise wrong(f"a car needs `{key}`", at=(key,), uses=("kind",))
            if self.kind != "car" and value is not None:
                raise wrong(
                    f"only a car has `{key}`",
                    given=f"kind: {self.kind}",
                    allowed="kind: car",
                    at=(key,),
                    uses=("kind",),
                )
        return self


class OdometryNoise(Part):
    """How odometry drifts: errors of the wheels' motion, integrated."""

    slip: NonNegative = Field(
        default=0.0, description="standard deviation of the relative error of a metre driven"
    )
    turn: NonNegative = Field(
        default=0.0, description="standard deviation of the relative error of a radian turned"
    )
    bias: tuple[NonNegative, NonNegative, NonNegative] = Field(
        default=(0.0, 0.0, 0.0),
        description="constant relative errors of ways ahead, of ways aside and of turns: each is "
        "drawn once a run, evenly from minus to plus half of this",
    )


class Sprayer(Part):
    """Paints the floor under it while bit 0 of its dio device is set."""

    type: Literal["sprayer"] = Field(description="paints the floor; Player's dio, bit 0")
    size: Size = Field(default=(1.0, 1.0), description="length and width of what it paints, m")
    offset: Point = Field(default=(0.0, 0.0), description="its centre in the robot's frame, m")


class Gripper(Part):
    """Holds what can be pushed and lies between its paddles when they close; Player's gripper."""

    type: Literal["gripper"] = Field(description="grips what can be pushed; Player's gripper")
    pose: Pose = Field(
        default=(0.3, 0.0, 0.0),
        description="the middle of the space between its paddles, x, y in m, and the heading in "
        "degrees in which they point, in the robot's frame",
    )
    space: Size = Field(
        default=(0.13, 0.24),
        description="length of the paddles, and how far they are apart when open, m",
    )


class Battery(Part):
    """What a robot draws on; Player's power."""

    capacity: Positive = Field(description="J that it holds")
    charge: NonNegative | None = Field(
        default=None, description="J that are in it at the start; null: as many as it holds"
    )
    idle: NonNegative = Field(default=0.0, description="W that are always drawn")
    driving: NonNegative = Field(default=0.0, description="W more at 1 m/s, in proportion to it")
    turning: NonNegative = Field(default=0.0, description="W more at 1 rad/s, in proportion to it")
    intake: NonNegative | None = Field(
        default=None, description="W at most that it takes from a charger; null: all that it gives"
    )

    @model_validator(mode="after")
    def _holds_its_charge(self) -> Self:
        if self.charge is not None and self.charge > self.capacity:
            raise wrong(
                "a battery holds no more than its capacity",
                given=f"{self.charge:g}",
                allowed=f"{self.capacity:g} at most",
                at=("charge",),
                uses=("capacity",),
            )
        return self


Actuator = Annotated[Sprayer | Gripper, Field(discriminator="type")]


class Model(Part):
    """One kind of robot."""

    body: Body = Field(description="the shape that bumps, pushes and is seen")
    drive: Drive | None = Field(
        default=Drive(), description="null: the robot cannot move by itself"
    )
    localization: Literal["odometry", "gps"] = Field(
        default="odometry",
        description="what position2d reports: odometry (the own start pose is 0, 0, 0) or gps "
        "(the world pose)",
    )
    odometry_origin: Pose | None = Field(
        default=None,
        description="x, y in m and heading in degrees: the pose in the world from which odometry "
        "counts; null: where the robot starts",
    )
    odometry_noise: OdometryNoise | None = Field(default=None, description="null: exact odometry")
    simulation: Literal["report", "full"] = Field(
        default="report",
        description="what Player's simulation interface may do: report (set properties on "
        "itself, read the time) or full (read and set any robot's pose)",
    )
    fiducial: Annotated[int, Field(ge=1, le=2**31 - 1)] | None = Field(
        default=None, description="an id that fiducial finders see"
    )
    sensors: tuple[Any, ...] = Field(
        default=(), description="order gives Player's index: the first laser is laser:0"
    )
    actuators: tuple[Actuator, ...] = Field(
        default=(), description="order gives the index of their dio, or gripper"
    )
    battery: Battery | None = Field(default=None, description="null: it needs none")

    @model_validator(mode="after")
    def _noise_needs_odometry(self) -> Self:
        for key, what in (
            ("odometry_noise", "a gps has no odometry to drift"),
            ("odometry_origin", "a gps counts from the world's origin"),
        ):
            if getattr(self, key) is not None and self.localization == "gps":
                raise wrong(
                    what,
                    given="localization: gps",
                    allowed=f"localization: odometry, or no {key}",
                    at=(key,),
                    uses=("localization",),
                )
        return self
