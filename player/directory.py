"""Which devices exist at one port of a server, and the simulated time there."""

from __future__ import annotations

import ipaddress
from collections.abc import Iterator, Mapping
from functools import cache

from player.codes import DeviceAddr
from player.header import FRONT
from player.messages import encode

Datum = tuple[DeviceAddr, int, bytes]
"""Data of a device: its address there, the subtype, the payload."""


@cache
def wire_address(host: str) -> int:
    """An IPv4 address as headers have it; 0 for any other host, as they have no room for it."""
    try:
        packed = ipaddress.IPv4Address(host).packed
    except ValueError:
        return 0
    return int.from_bytes(packed, "little")


class Directory:
    """Devices of one port: address -> driver name. It may grow and shrink while clients look.

    `time` is the simulated time in seconds that replies are stamped with; whoever owns the clock
    keeps it. `host` (IPv4) and `port` are what clients are told; `place` changes them.
    """

    def __init__(
        self,
        devices: Mapping[DeviceAddr, str] | None = None,
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        time: float = 0.0,
    ) -> None:
        self.time = time
        self.drivers: dict[DeviceAddr, str] = {}
        """The devices, and the names of their drivers: to be looked at."""
        self._list: bytes | None = None
        self._fronts: dict[tuple[int, int, int, int], bytes] = {}
        self.place(host, port)
        for addr, driver in (devices or {}).items():
            self.add(addr, driver)

    def add(self, addr: DeviceAddr, driver: str = "troupe") -> None:
        """Adds a device; the driver's name is what clients show (at most 62 bytes)."""
        if len(driver.encode()) > 62:
            raise ValueError(f"driver name {driver!r} is longer than 62 bytes")
        self.drivers[DeviceAddr(*addr)] = driver
        self._list = None

    def remove(self, addr: DeviceAddr) -> None:
        """Removes a device; KeyError if there is none."""
        del self.drivers[addr]
        self._list = None

    def __contains__(self, addr: object) -> bool:
        return addr in self.drivers

    def __iter__(self) -> Iterator[DeviceAddr]:
        return iter(self.drivers)

    def __len__(self) -> int:
        return len(self.drivers)

    def driver(self, addr: DeviceAddr) -> str:
        """The driver's name, "" if there is no such device."""
        return self.drivers.get(addr, "")

    def place(self, host: str, port: int) -> None:
        """Sets what clients are told in headers and lists: an IPv4 address and a port."""
        self.host = host
        self.port = port
        self.wire_host = wire_address(host)
        """The address as it stands in headers: 127.0.0.1 is 0x0100007f."""
        self._list = None
        self._fronts.clear()

    def front(self, interf: int, index: int, type: int, subtype: int) -> bytes:
        """The header of data, or of an answer, from here, up to its timestamp; it is kept."""
        kind = (interf, index, type, subtype)
        front = self._fronts.get(kind)
        if front is None:
            front = self._fronts[kind] = FRONT.pack(self.wire_host, self.port, *kind)
        return front

    def listing(self) -> bytes:
        """The payload of the device list's ACK."""
        if self._list is None:
            rows = [(self.wire_host, self.port, *addr) for addr in self.drivers]
            self._list = encode(1, 4, 1, devices=rows)
        return self._list
