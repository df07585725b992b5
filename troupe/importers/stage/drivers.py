"""Player's configuration file: which devices of which models are served at which port and index."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from player.codes import DEFAULT_PORT, Interface
from sim.worldfile.mistakes import suggestion
from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity, Property, read_file
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place, StageError

TYPES = frozenset({"driver", "interface"})

CHILDREN = {
    "ranger": ("ranger", "laser", "sonar"),
    "laser": ("laser", "ranger"),
    "sonar": ("sonar", "ranger"),
    "blobfinder": ("blobfinder",),
    "fiducial": ("fiducial", "fiducialfinder"),
    "bumper": ("bumper",),
    "gripper": ("gripper",),
}
"""The types of Stage's models that an interface takes, the first unused one of a robot."""

OF_THE_ROBOT = ("position2d", "simulation", "speech", "graphics2d", "power")
"""Interfaces of the position model itself, or of the world."""


@dataclass(frozen=True, slots=True)
class Address:
    """`port:interface:index`, as a client sees it."""

    port: int
    interface: str
    index: int

    def __str__(self) -> str:
        return f"{self.port}:{self.interface}:{self.index}"


@dataclass(frozen=True, slots=True)
class Served:
    """A device of a robot: of the robot itself, or of the sensor model `part`."""

    address: Address
    robot: str
    part: str | None
    place: Place


@dataclass
class Table:
    """What a configuration file serves, in its order."""

    served: list[Served] = field(default_factory=list)
    simulation: bool = False

    @property
    def robots(self) -> list[str]:
        """Names of the robots that have a device in it."""
        return list(dict.fromkeys(one.robot for one in self.served))

    @property
    def scanners(self) -> set[str]:
        """Names of the rangers that are served as lasers."""
        return {
            one.part
            for one in self.served
            if one.part is not None and one.address.interface == "laser"
        }


def read_table(path: str, robots: Sequence[Thing], notes: Notes) -> Table:
    """Read a .cfg for a world with these robots. Raises StageError."""
    drivers = [child for child in read_file(path, TYPES).children if child.type == "driver"]
    table = Table()
    parts = {part.name: (robot, part) for robot in robots for part in robot.all()}
    for driver in drivers:
        driver.used |= {"alwayson", "usegui", "worldfile", "plugin"}
        if values.text(driver, "name", "") == "stage":
            _stage_driver(driver, parts, table, notes)
    for driver in drivers:
        name = values.text(driver, "name", "")
        if name == "rangertolaser":
            _converter(driver, table, notes)
        elif name != "stage":
            driver.used |= set(driver.properties)
            notes.lost(
                driver.place,
                f"driver {name or 'without a name'}: Player's own drivers are not run here",
            )
    for driver in drivers:
        for key in set(driver.properties) - driver.used:
            notes.unneeded(driver.properties[key].place, f"{key}: an option of a driver")
    return table


def _addresses(found: Property | None) -> list[tuple[str, Address]]:
    """The addresses of a `provides` or `requires`, with their keys."""
    result: list[tuple[str, Address]] = []
    if found is None:
        return result
    for text in map(str, found.values):
        *before, interface, index = ["", *text.strip().split(":")]
        # before them, as far as given: key, host, port; each may be empty
        port = before.pop() if before and (not before[-1] or before[-1].isdecimal()) else ""
        if not (interface.isidentifier() and index.isdecimal() and len(before) < 4):
            raise StageError(found.place, f"{text!r} is no address such as 6665:position2d:0")
        result.append(
            (
                before[-1] if before else "",
                Address(int(port or DEFAULT_PORT), interface, int(index)),
            )
        )
    return result


def _stage_driver(
    driver: Entity, parts: dict[str, tuple[Thing, Thing]], table: Table, notes: Notes
) -> None:
    """What a driver of Stage's provides: devices of a robot, or of a sensor that is named itself.

    parts: of each name the robot that has it, and the robot itself or what it carries.
    """
    provides = values.get(driver, "provides")
    if provides is None:
        raise StageError(driver.place, "a driver needs provides [ ... ]")
    model = values.text(driver, "model", "")
    for _, address in _addresses(provides):
        name = address.interface
        place = provides.place
        if name == "simulation":
            table.simulation = True
            continue
        if not model:
            notes.lost(place, f"{address}: the driver does not say which model it is of")
            continue
        if model not in parts:
            hint = suggestion(model, parts)
            notes.lost(place, f"{name} of {model}, which is no robot{hint}: it is not served here")
            continue
        robot, named = parts[model]
        if name.upper() not in Interface.__members__:
            notes.lost(place, f"Player has no interface {name}")
            continue
        if name in OF_THE_ROBOT:
            table.served.append(Served(address, robot.name, None, place))
        elif name in CHILDREN:
            part = _unused(named, name, table)
            if part is None:
                notes.lost(place, f"{name}: the model has none left that it could be")
            else:
                table.served.append(Served(address, robot.name, part.name, place))
        else:
            notes.lost(place, f"{name}: the interface is not served here")


def _unused(named: Thing, interface: str, table: Table) -> Thing | None:
    """The sensor model that is meant: the first one of what is named that is not given away.

    Of Stage 2 and 3 there are tables that ask for lasers and sonars by these names; a ranger that
    scans is then the laser, one of single beams the sonar.
    """
    taken = {one.part for one in table.served}
    kinds = CHILDREN[interface]
    fitting = [one for one in named.all() if one.entity.type in kinds and one.name not in taken]
    if interface in ("laser", "sonar"):
        fitting = [one for one in fitting if _scans(one) == (interface == "laser")]
    return fitting[0] if fitting else None


def _scans(thing: Thing) -> bool:
    """Whether a ranging model casts several rays from one place."""
    parts = [child for child in thing.entity.children if child.type == "sensor"]
    return thing.entity.type == "laser" or any(
        values.number(part, "samples", 1) > 1 for part in parts
    )


def _converter(driver: Entity, table: Table, notes: Notes) -> None:
    """rangertolaser: a ranger that is served as a laser too."""
    required = _addresses(values.get(driver, "requires"))
    provided = _addresses(values.get(driver, "provides"))
    sources = {one.address: one for one in table.served}
    for (_, wanted), (_, offered) in zip(required, provided, strict=False):
        source = sources.get(wanted)
        if source is None:
            place = driver.properties["requires"].place
            notes.lost(place, f"{wanted}: nobody provides it")
            continue
        place = driver.properties["provides"].place
        table.served.append(Served(offered, source.robot, source.part, place))
