"""At which port and index our server will have the devices that a driver table promises."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from player.codes import DEFAULT_PORT
from troupe.importers.stage.drivers import Address, Served, Table
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.robots import Robot

Layout = Literal["per_robot", "shared"]


@dataclass(frozen=True)
class Ports:
    """The `player` part of the world file."""

    port: int
    layout: Layout

    @property
    def data(self) -> dict[str, Any]:
        """As a mapping of the world file."""
        return {"port": self.port, "layout": self.layout}


def in_order_of_ports(robots: Sequence[Robot], table: Table) -> list[Robot]:
    """The robots in the table's order of port and index; those that it leaves out at the end.

    Our server numbers robots as they stand in the world file.
    """
    place: dict[str, tuple[int, int]] = {}
    for one in table.served:
        at = (one.address.port, one.address.index)
        if one.address.interface == "position2d" or one.robot not in place:
            place[one.robot] = at
    last = (1 << 16, 0)
    return sorted(robots, key=lambda robot: place.get(robot.thing.name, last))


def ports_of(table: Table) -> Ports:
    """One port for all if the table has several robots at one; else a port for each."""
    ports: dict[int, set[str]] = {}
    for one in table.served:
        ports.setdefault(one.address.port, set()).add(one.robot)
    first = min(ports, default=DEFAULT_PORT)
    shared = len(ports) == 1 and len(ports[first]) > 1
    return Ports(first, "shared" if shared else "per_robot")


def served_at(robots: Sequence[Robot], ports: Ports) -> dict[Address, tuple[str, str | None]]:
    """What will be where: of each address the robot, and the sensor model if it is of one.

    The order in which devices take their indices is that of `sim.devices.build`.
    """
    found: dict[Address, tuple[str, str | None]] = {}
    counts: Counter[str] = Counter()
    for number, robot in enumerate(robots):
        if ports.layout == "per_robot":
            counts.clear()
        port = ports.port + (number if ports.layout == "per_robot" else 0)
        name = robot.thing.name
        devices: list[tuple[str, str | None]] = []
        twins: list[tuple[str, str | None]] = []
        part: str | None
        if robot.drive is not None:
            devices.append(("position2d", None))
        for sensor in robot.sensors:
            kind, part = sensor.data["type"], sensor.thing.name
            devices.append((kind, part))
            if kind == "laser":
                twins.append(("ranger", part))
            elif kind == "ranger" and "samples" not in sensor.data:
                twins.append(("sonar", part))
        if "fiducial" in robot.rest and not any(kind == "fiducial" for kind, _ in devices):
            devices.append(("fiducial", None))
        twins += [("gripper", one.thing.name) for one in robot.grippers]
        twins += [("power", None)] if "battery" in robot.rest else []
        twins += [("speech", None), ("graphics2d", None)]
        if not counts["simulation"]:  # one at a port
            twins.append(("simulation", None))
        for interface, part in devices + twins:
            found[Address(port, interface, counts[interface])] = (name, part)
            counts[interface] += 1
    return found


def check_addresses(table: Table, robots: Sequence[Robot], ports: Ports, notes: Notes) -> None:
    """Note every device of the table that our server has at another address."""
    ours = served_at(robots, ports)
    for one in table.served:
        address = one.address
        if address.interface == "simulation" or ours.get(address) == (one.robot, one.part):
            continue
        notes.differs(one.place, f"{address} of {one.robot}: {_elsewhere(one, ours)}")


def _elsewhere(one: Served, ours: dict[Address, tuple[str, str | None]]) -> str:
    for address, whose in ours.items():
        if address.interface == one.address.interface and whose == (one.robot, one.part):
            return f"at {address} here"
    return "not served here"
