"""Every message that Troupe knows, as one table: interface, type, subtype -> name and fields.

Layouts follow Player's interface definitions. An interface's ACK stands after its request; a NACK,
and whatever is not listed with fields, is empty.
"""

from __future__ import annotations

from typing import NamedTuple

from player.codes import Interface as I
from player.codes import MessageType
from player.xdr import (
    ADDR,
    BOX2D,
    BOX3D,
    COLOR,
    F32,
    F64,
    I32,
    POINT2D,
    POSE2D,
    POSE3D,
    U8,
    U16,
    U32,
    Array,
    Field,
    Octets,
    Text,
    record,
)

DATA, CMD, REQ, ACK, SYNCH, NACK = MessageType


class Blob(NamedTuple):
    """A blob of the blobfinder: pixels, x to the robot's right, y downward; range in metres."""

    id: int
    color: int
    area: int
    x: int
    y: int
    left: int
    right: int
    top: int
    bottom: int
    range: float


class Fiducial(NamedTuple):
    """A fiducial: id, its pose relative to the detector, and the pose's uncertainty (`ux`, ...)."""

    id: int
    x: float
    y: float
    z: float
    roll: float
    pitch: float
    yaw: float
    ux: float
    uy: float
    uz: float
    uroll: float
    upitch: float
    uyaw: float


class BumperSegment(NamedTuple):
    """One bumper segment: its pose on the robot, its length and radius of curvature, metres."""

    x: float
    y: float
    z: float
    roll: float
    pitch: float
    yaw: float
    length: float
    radius: float


BLOB = record(Blob, *[U32] * 9, F32)
FIDUCIAL = record(Fiducial, I32, *[F64] * 12)
BUMPER = record(BumperSegment, *[F64] * 6, *[F32] * 2)

Fields = tuple[Field, ...]

EMPTY: Fields = ()
STATE: Fields = (("state", U8),)
VALUE: Fields = (("value", U8),)
GEOMETRY: Fields = (("pose", POSE3D), ("size", BOX3D))
PID: Fields = (("kp", F32), ("ki", F32), ("kd", F32))

DRIVER: Fields = (("addr", ADDR), ("driver", Text(64)))
SUBSCRIPTION: Fields = (("addr", ADDR), ("access", U8), ("driver", Text(64)))

SCAN: Fields = (
    ("min_angle", F32),
    ("max_angle", F32),
    ("resolution", F32),
    ("max_range", F32),
    ("ranges", Array(F32)),
    ("intensity", Octets()),
    ("id", U32),
)
LASER_CONFIG: Fields = (
    ("min_angle", F32),
    ("max_angle", F32),
    ("resolution", F32),
    ("max_range", F32),
    ("range_resolution", F32),
    ("intensity", U8),
    ("scanning_frequency", F32),
)
RANGER_GEOMETRY: Fields = (
    *GEOMETRY,
    ("element_poses", Array(POSE3D)),
    ("element_sizes", Array(BOX3D)),
)
RANGER_CONFIG: Fields = (
    ("min_angle", F64),
    ("max_angle", F64),
    ("angular_resolution", F64),
    ("min_range", F64),
    ("max_range", F64),
    ("range_resolution", F64),
    ("frequency", F64),
)
RANGER_STAMP: Fields = (
    ("have_geometry", U8),
    *RANGER_GEOMETRY,
    ("have_config", U8),
    *((f"config_{name}", kind) for name, kind in RANGER_CONFIG),
)
BLOB_COLOR: Fields = (
    ("channel", U32),
    ("red_min", U32),
    ("red_max", U32),
    ("green_min", U32),
    ("green_max", U32),
    ("blue_min", U32),
    ("blue_max", U32),
)
IMAGER: Fields = (("brightness", I32), ("contrast", I32), ("colormode", I32), ("autogain", I32))
FOV: Fields = (("min_range", F32), ("max_range", F32), ("view_angle", F32))
NAMED_POSE2D: Fields = (("name", Text()), ("pose", POSE2D))
NAMED_POSE3D: Fields = (("name", Text()), ("pose", POSE3D), ("simtime", F64))
PROPERTY: Fields = (("name", Text()), ("property", Text()), ("index", U32), ("value", Octets()))
POINTS: Fields = (("points", Array(POINT2D)), ("color", COLOR))
DIO: Fields = (("count", U32), ("bits", U32))
REPLACE_RULE: Fields = (
    ("interf", I32),
    ("index", I32),
    ("type", I32),
    ("subtype", I32),
    ("replace", I32),
)

Row = tuple[I, MessageType, int, str, Fields]

TABLE: tuple[Row, ...] = (
    # the server itself
    (I.PLAYER, REQ, 1, "device_list", EMPTY),
    (I.PLAYER, ACK, 1, "device_list", (("devices", Array(ADDR)),)),
    (I.PLAYER, REQ, 2, "driver_info", DRIVER),
    (I.PLAYER, ACK, 2, "driver_info", DRIVER),
    (I.PLAYER, REQ, 3, "subscription", SUBSCRIPTION),
    (I.PLAYER, ACK, 3, "subscription", SUBSCRIPTION),
    (I.PLAYER, NACK, 3, "subscription", SUBSCRIPTION),
    (I.PLAYER, REQ, 4, "data", EMPTY),
    (I.PLAYER, ACK, 4, "data", EMPTY),
    (I.PLAYER, REQ, 5, "data_mode", (("mode", U8),)),
    (I.PLAYER, ACK, 5, "data_mode", EMPTY),
    (I.PLAYER, REQ, 7, "auth", (("key", Octets(32)),)),
    (I.PLAYER, ACK, 7, "auth", EMPTY),
    (I.PLAYER, REQ, 8, "name_service", (("name", Text()), ("port", U16))),
    (I.PLAYER, ACK, 8, "name_service", (("name", Text()), ("port", U16))),
    (I.PLAYER, REQ, 10, "replace_rule", REPLACE_RULE),
    (I.PLAYER, ACK, 10, "replace_rule", EMPTY),
    (I.PLAYER, SYNCH, 1, "ok", EMPTY),
    (I.PLAYER, SYNCH, 2, "overflow", (("dropped", U32),)),
    # position2d
    (I.POSITION2D, DATA, 1, "state", (("pos", POSE2D), ("vel", POSE2D), ("stall", U8))),
    (I.POSITION2D, DATA, 2, "geometry", GEOMETRY),
    (I.POSITION2D, CMD, 1, "velocity", (("vel", POSE2D), ("state", U8))),
    (I.POSITION2D, CMD, 2, "position", (("pos", POSE2D), ("vel", POSE2D), ("state", U8))),
    (I.POSITION2D, CMD, 3, "car", (("velocity", F64), ("angle", F64))),
    (I.POSITION2D, CMD, 4, "velocity_heading", (("velocity", F64), ("heading", F64))),
    (I.POSITION2D, REQ, 1, "geometry", EMPTY),
    (I.POSITION2D, ACK, 1, "geometry", GEOMETRY),
    (I.POSITION2D, REQ, 2, "motor_power", STATE),
    (I.POSITION2D, ACK, 2, "motor_power", EMPTY),
    (I.POSITION2D, REQ, 3, "velocity_mode", (("value", U32),)),
    (I.POSITION2D, ACK, 3, "velocity_mode", EMPTY),
    (I.POSITION2D, REQ, 4, "position_mode", (("state", U32),)),
    (I.POSITION2D, ACK, 4, "position_mode", EMPTY),
    (I.POSITION2D, REQ, 5, "set_odometry", (("pose", POSE2D),)),
    (I.POSITION2D, ACK, 5, "set_odometry", EMPTY),
    (I.POSITION2D, REQ, 6, "reset_odometry", EMPTY),
    (I.POSITION2D, ACK, 6, "reset_odometry", EMPTY),
    (I.POSITION2D, REQ, 7, "speed_pid", PID),
    (I.POSITION2D, ACK, 7, "speed_pid", EMPTY),
    (I.POSITION2D, REQ, 8, "position_pid", PID),
    (I.POSITION2D, ACK, 8, "position_pid", EMPTY),
    (I.POSITION2D, REQ, 9, "speed_profile", (("speed", F32), ("acceleration", F32))),
    (I.POSITION2D, ACK, 9, "speed_profile", EMPTY),
    # power
    (
        I.POWER,
        DATA,
        1,
        "state",
        (
            ("valid", U32),
            ("volts", F32),
            ("percent", F32),
            ("joules", F32),
            ("watts", F32),
            ("charging", I32),
        ),
    ),
    (I.POWER, REQ, 1, "set_charging_policy", (("enable_input", U8), ("enable_output", U8))),
    (I.POWER, ACK, 1, "set_charging_policy", EMPTY),
    # gripper
    (I.GRIPPER, DATA, 1, "state", (("state", U8), ("beams", U32), ("stored", U8))),
    (I.GRIPPER, CMD, 1, "open", EMPTY),
    (I.GRIPPER, CMD, 2, "close", EMPTY),
    (I.GRIPPER, CMD, 3, "stop", EMPTY),
    (I.GRIPPER, CMD, 4, "store", EMPTY),
    (I.GRIPPER, CMD, 5, "retrieve", EMPTY),
    (I.GRIPPER, REQ, 1, "geometry", EMPTY),
    (
        I.GRIPPER,
        ACK,
        1,
        "geometry",
        (
            ("pose", POSE3D),
            ("outer_size", BOX3D),
            ("inner_size", BOX3D),
            ("beams", U8),
            ("capacity", U8),
        ),
    ),
    # sonar
    (I.SONAR, DATA, 1, "ranges", (("ranges", Array(F32)),)),
    (I.SONAR, DATA, 2, "geometry", (("poses", Array(POSE3D)),)),
    (I.SONAR, REQ, 1, "geometry", EMPTY),
    (I.SONAR, ACK, 1, "geometry", (("poses", Array(POSE3D)),)),
    (I.SONAR, REQ, 2, "power", STATE),
    (I.SONAR, ACK, 2, "power", EMPTY),
    # laser
    (I.LASER, DATA, 1, "scan", SCAN),
    (I.LASER, DATA, 2, "scan_pose", (*SCAN, ("pose", POSE2D))),
    (
        I.LASER,
        DATA,
        3,
        "scan_angle",
        (
            ("max_range", F32),
            ("ranges", Array(F32)),
            ("angles", Array(F32)),
            ("intensity", Octets()),
            ("id", U32),
        ),
    ),
    (I.LASER, REQ, 1, "geometry", EMPTY),
    (I.LASER, ACK, 1, "geometry", GEOMETRY),
    (I.LASER, REQ, 2, "set_config", LASER_CONFIG),
    (I.LASER, ACK, 2, "set_config", LASER_CONFIG),
    (I.LASER, REQ, 3, "get_config", EMPTY),
    (I.LASER, ACK, 3, "get_config", LASER_CONFIG),
    (I.LASER, REQ, 4, "power", STATE),
    (I.LASER, ACK, 4, "power", EMPTY),
    (I.LASER, REQ, 5, "get_id", EMPTY),
    (I.LASER, ACK, 5, "get_id", (("serial_number", U32),)),
    (I.LASER, REQ, 6, "set_filter", (("filter", U8), ("parameters", Array(F32)))),
    (I.LASER, ACK, 6, "set_filter", EMPTY),
    # ranger
    (I.RANGER, DATA, 1, "ranges", (("ranges", Array(F64)),)),
    (I.RANGER, DATA, 2, "ranges_stamped", (("ranges", Array(F64)), *RANGER_STAMP)),
    (I.RANGER, DATA, 3, "intensities", (("intensities", Array(F64)),)),
    (I.RANGER, DATA, 4, "intensities_stamped", (("intensities", Array(F64)), *RANGER_STAMP)),
    (I.RANGER, DATA, 5, "geometry", RANGER_GEOMETRY),
    (I.RANGER, REQ, 1, "geometry", EMPTY),
    (I.RANGER, ACK, 1, "geometry", RANGER_GEOMETRY),
    (I.RANGER, REQ, 2, "power", VALUE),
    (I.RANGER, ACK, 2, "power", EMPTY),
    (I.RANGER, REQ, 3, "intensity", VALUE),
    (I.RANGER, ACK, 3, "intensity", EMPTY),
    (I.RANGER, REQ, 4, "set_config", RANGER_CONFIG),
    (I.RANGER, ACK, 4, "set_config", RANGER_CONFIG),
    (I.RANGER, REQ, 5, "get_config", EMPTY),
    (I.RANGER, ACK, 5, "get_config", RANGER_CONFIG),
    # blobfinder
    (I.BLOBFINDER, DATA, 1, "blobs", (("width", U32), ("height", U32), ("blobs", Array(BLOB)))),
    (I.BLOBFINDER, REQ, 1, "set_color", BLOB_COLOR),
    (I.BLOBFINDER, ACK, 1, "set_color", EMPTY),
    (I.BLOBFINDER, REQ, 2, "set_imager", IMAGER),
    (I.BLOBFINDER, ACK, 2, "set_imager", EMPTY),
    (I.BLOBFINDER, REQ, 3, "get_color", EMPTY),
    (I.BLOBFINDER, ACK, 3, "get_color", BLOB_COLOR),
    # fiducial
    (I.FIDUCIAL, DATA, 1, "fiducials", (("fiducials", Array(FIDUCIAL)),)),
    (I.FIDUCIAL, REQ, 1, "geometry", EMPTY),
    (I.FIDUCIAL, ACK, 1, "geometry", (*GEOMETRY, ("fiducial_size", BOX2D))),
    (I.FIDUCIAL, REQ, 2, "get_fov", EMPTY),
    (I.FIDUCIAL, ACK, 2, "get_fov", FOV),
    (I.FIDUCIAL, REQ, 3, "set_fov", FOV),
    (I.FIDUCIAL, ACK, 3, "set_fov", FOV),
    (I.FIDUCIAL, REQ, 7, "get_id", EMPTY),
    (I.FIDUCIAL, ACK, 7, "get_id", (("id", U32),)),
    (I.FIDUCIAL, REQ, 8, "set_id", (("id", U32),)),
    (I.FIDUCIAL, ACK, 8, "set_id", (("id", U32),)),
    # speech, bumper, dio, aio
    (I.SPEECH, CMD, 1, "say", (("text", Text()),)),
    (I.BUMPER, DATA, 1, "state", (("bumpers", Octets()),)),
    (I.BUMPER, DATA, 2, "geometry", (("bumpers", Array(BUMPER)),)),
    (I.BUMPER, REQ, 1, "geometry", EMPTY),
    (I.BUMPER, ACK, 1, "geometry", (("bumpers", Array(BUMPER)),)),
    (I.DIO, DATA, 1, "values", DIO),
    (I.DIO, CMD, 1, "values", DIO),
    (I.AIO, DATA, 1, "state", (("voltages", Array(F32)),)),
    (I.AIO, CMD, 1, "state", (("id", U32), ("voltage", F32))),
    # simulation
    (I.SIMULATION, CMD, 1, "pause", EMPTY),
    (I.SIMULATION, CMD, 2, "reset", EMPTY),
    (I.SIMULATION, CMD, 3, "save", EMPTY),
    (I.SIMULATION, REQ, 1, "get_pose2d", NAMED_POSE2D),
    (I.SIMULATION, ACK, 1, "get_pose2d", NAMED_POSE2D),
    (I.SIMULATION, REQ, 2, "set_pose2d", NAMED_POSE2D),
    (I.SIMULATION, ACK, 2, "set_pose2d", EMPTY),
    (I.SIMULATION, REQ, 3, "get_pose3d", NAMED_POSE3D),
    (I.SIMULATION, ACK, 3, "get_pose3d", NAMED_POSE3D),
    (I.SIMULATION, REQ, 4, "set_pose3d", NAMED_POSE3D),
    (I.SIMULATION, ACK, 4, "set_pose3d", EMPTY),
    (I.SIMULATION, REQ, 5, "get_property", PROPERTY),
    (I.SIMULATION, ACK, 5, "get_property", PROPERTY),
    (I.SIMULATION, REQ, 6, "set_property", PROPERTY),
    (I.SIMULATION, ACK, 6, "set_property", EMPTY),
    # log
    (I.LOG, REQ, 1, "set_write_state", STATE),
    (I.LOG, ACK, 1, "set_write_state", EMPTY),
    (I.LOG, REQ, 2, "set_read_state", STATE),
    (I.LOG, ACK, 2, "set_read_state", EMPTY),
    (I.LOG, REQ, 3, "get_state", EMPTY),
    (I.LOG, ACK, 3, "get_state", (("type", U8), ("state", U8))),
    (I.LOG, REQ, 4, "rewind", EMPTY),
    (I.LOG, ACK, 4, "rewind", EMPTY),
    (I.LOG, REQ, 5, "set_filename", (("filename", Text(256, nul=False)),)),
    (I.LOG, ACK, 5, "set_filename", EMPTY),
    # graphics2d
    (I.GRAPHICS2D, CMD, 1, "clear", EMPTY),
    (I.GRAPHICS2D, CMD, 2, "points", POINTS),
    (I.GRAPHICS2D, CMD, 3, "polyline", POINTS),
    (
        I.GRAPHICS2D,
        CMD,
        4,
        "polygon",
        (("points", Array(POINT2D)), ("color", COLOR), ("fill_color", COLOR), ("filled", U8)),
    ),
    (I.GRAPHICS2D, CMD, 5, "multiline", POINTS),
)

UNIVERSAL: tuple[tuple[MessageType, int, str, Fields], ...] = (
    # requests that any device may be asked, whatever its interface
    (REQ, 255, "capabilities", (("type", U32), ("subtype", U32))),
    (ACK, 255, "capabilities", EMPTY),
    *(
        (type_, subtype, f"{verb}_{kind}_property", (("key", Text()), ("value", value)))
        for get, set_, kind, value in (
            (254, 253, "int", I32),
            (252, 251, "double", F64),
            (250, 249, "string", Text()),
            (248, 247, "bool", U8),
        )
        for subtype, verb in ((get, "get"), (set_, "set"))
        for type_ in (REQ, ACK)
    ),
)
