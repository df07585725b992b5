"""The Player half: protocol, sessions, server, client and proxies."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from player.client import PlayerClient
    from player.codes import (
        DEFAULT_PORT,
        Access,
        DataMode,
        DeviceAddr,
        Interface,
        MessageType,
        Replace,
    )
    from player.errors import (
        NoReading,
        PlayerDisconnected,
        PlayerError,
        PlayerRefused,
        PlayerTimeout,
        ProtocolError,
        XdrError,
    )
    from player.proxies import (
        AioProxy,
        Blob,
        BlobfinderProxy,
        BumperProxy,
        DioProxy,
        FiducialProxy,
        Geometry,
        Graphics2dProxy,
        GripperGeometry,
        GripperProxy,
        LaserConfig,
        LaserProxy,
        Position2dProxy,
        PowerProxy,
        Proxy,
        RangerConfig,
        RangerGeometry,
        RangerProxy,
        SimulationProxy,
        Size,
        SpeechProxy,
    )
    from player.robot import Robot, run
    from player.table import BumperSegment, Fiducial
    from player.xdr import Pose2d, Pose3d

# Names are imported on first use: who only wants `player.printable` need not wait for numpy.
_HOMES = {
    "client": ["PlayerClient"],
    "codes": [
        "DEFAULT_PORT",
        "Access",
        "DataMode",
        "DeviceAddr",
        "Interface",
        "MessageType",
        "Replace",
    ],
    "errors": [
        "NoReading",
        "PlayerDisconnected",
        "PlayerError",
        "PlayerRefused",
        "PlayerTimeout",
        "ProtocolError",
        "XdrError",
    ],
    "robot": ["Robot", "run"],
    "table": ["BumperSegment", "Fiducial"],
    "xdr": ["Pose2d", "Pose3d"],
}
__all__ = [
    "DEFAULT_PORT",
    "Access",
    "AioProxy",
    "Blob",
    "BlobfinderProxy",
    "BumperProxy",
    "BumperSegment",
    "DataMode",
    "DeviceAddr",
    "DioProxy",
    "Fiducial",
    "FiducialProxy",
    "Geometry",
    "Graphics2dProxy",
    "GripperGeometry",
    "GripperProxy",
    "Interface",
    "LaserConfig",
    "LaserProxy",
    "MessageType",
    "NoReading",
    "PlayerClient",
    "PlayerDisconnected",
    "PlayerError",
    "PlayerRefused",
    "PlayerTimeout",
    "Pose2d",
    "Pose3d",
    "Position2dProxy",
    "PowerProxy",
    "ProtocolError",
    "Proxy",
    "RangerConfig",
    "RangerGeometry",
    "RangerProxy",
    "Replace",
    "Robot",
    "SimulationProxy",
    "Size",
    "SpeechProxy",
    "XdrError",
    "run",
]


# all others are proxies, and what these give
_HOME = dict.fromkeys(__all__, "proxies")
_HOME |= {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = getattr(import_module(f"player.{_HOME[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """What there is to be used, loaded or not yet."""
    return sorted(__all__)
