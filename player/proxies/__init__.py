"""What a controller holds of its robot's devices: one proxy class per interface."""

from player.proxies.aio import AioProxy
from player.proxies.base import Geometry, Proxy, Size
from player.proxies.blobfinder import Blob, BlobfinderProxy
from player.proxies.bumper import BumperProxy
from player.proxies.dio import DioProxy
from player.proxies.fiducial import FiducialProxy
from player.proxies.graphics2d import Graphics2dProxy
from player.proxies.gripper import GripperGeometry, GripperProxy
from player.proxies.laser import LaserConfig, LaserProxy
from player.proxies.position2d import Position2dProxy
from player.proxies.power import PowerProxy
from player.proxies.ranger import RangerConfig, RangerGeometry, RangerProxy
from player.proxies.simulation import SimulationProxy
from player.proxies.speech import SpeechProxy

__all__ = [
    "AioProxy",
    "Blob",
    "BlobfinderProxy",
    "BumperProxy",
    "DioProxy",
    "FiducialProxy",
    "Geometry",
    "Graphics2dProxy",
    "GripperGeometry",
    "GripperProxy",
    "LaserConfig",
    "LaserProxy",
    "Position2dProxy",
    "PowerProxy",
    "Proxy",
    "RangerConfig",
    "RangerGeometry",
    "RangerProxy",
    "SimulationProxy",
    "Size",
    "SpeechProxy",
]
