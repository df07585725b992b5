"""What a controller holds of its robot's devices: one proxy class per interface."""

from player.proxies.base import Geometry, Proxy, Size
from player.proxies.laser import LaserConfig, LaserProxy
from player.proxies.outputs import DioProxy, SpeechProxy
from player.proxies.position2d import Position2dProxy
from player.proxies.ranger import RangerConfig, RangerGeometry, RangerProxy
from player.proxies.simulation import SimulationProxy
from player.proxies.touch import BumperProxy
from player.proxies.vision import BlobfinderProxy, FiducialProxy

__all__ = [
    "BlobfinderProxy",
    "BumperProxy",
    "DioProxy",
    "FiducialProxy",
    "Geometry",
    "LaserConfig",
    "LaserProxy",
    "Position2dProxy",
    "Proxy",
    "RangerConfig",
    "RangerGeometry",
    "RangerProxy",
    "SimulationProxy",
    "Size",
    "SpeechProxy",
]
