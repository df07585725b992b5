"""What a controller holds of its robot's devices: one proxy class per interface."""

from player.proxies.aio import AioProxy
from player.proxies.base import Geometry, Proxy, Size
from player.proxies.graphics2d import Graphics2dProxy
from player.proxies.laser import LaserConfig, LaserProxy
from player.proxies.outputs import DioProxy, SpeechProxy
from player.proxies.position2d import Position2dProxy
from player.proxies.ranger import RangerConfig, RangerGeometry, RangerProxy
from player.proxies.simulation import SimulationProxy
from player.proxies.touch import BumperProxy
from player.proxies.vision import Blob, BlobfinderProxy, FiducialProxy

__all__ = [
    "AioProxy",
    "Blob",
    "BlobfinderProxy",
    "BumperProxy",
    "DioProxy",
    "FiducialProxy",
    "Geometry",
    "Graphics2dProxy",
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
