"""What a robot perceives: arrays in, readings out."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sensors.colors import format_color, parse_color
    from sensors.noise import gaussians
    from sensors.odometry import Odometry
    from sensors.rays import cast
    from sensors.readings import Bits, Blobs, Elements, Fan, Fiducials, Intensities, Scalars, Scans
    from sensors.registry import SENSORS, describe, load_file, sensor, settings_for
    from sensors.scene import Scene
    from sensors.settings import Color, Count, Number, Pose, SensorSettings, setting
    from sensors.suite import Suite
    from sensors.view import Contacts, View

# Names are imported on first use: who only wants a colour's number need not wait for numba.
_HOMES = {
    "colors": ["format_color", "parse_color"],
    "noise": ["gaussians"],
    "odometry": ["Odometry"],
    "rays": ["cast"],
    "readings": [
        "Bits",
        "Blobs",
        "Elements",
        "Fan",
        "Fiducials",
        "Intensities",
        "Scalars",
        "Scans",
    ],
    "registry": ["SENSORS", "describe", "load_file", "sensor", "settings_for"],
    "scene": ["Scene"],
    "settings": ["Color", "Count", "Number", "Pose", "SensorSettings", "setting"],
    "suite": ["Suite"],
    "view": ["Contacts", "View"],
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "SENSORS",
    "Bits",
    "Blobs",
    "Color",
    "Contacts",
    "Count",
    "Elements",
    "Fan",
    "Fiducials",
    "Intensities",
    "Number",
    "Odometry",
    "Pose",
    "Scalars",
    "Scans",
    "Scene",
    "SensorSettings",
    "Suite",
    "View",
    "cast",
    "describe",
    "format_color",
    "gaussians",
    "load_file",
    "parse_color",
    "sensor",
    "setting",
    "settings_for",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    """What there is to be used, loaded or not yet."""
    return sorted(__all__)
