"""From Stage's world file, and Player's configuration file, to a world file of ours."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.bitmap import Bools, draw
from troupe.importers.stage.carried import movable_of, posed
from troupe.importers.stage.drivers import Table, read_table
from troupe.importers.stage.footprint import height_of
from troupe.importers.stage.leftover import note_leftovers, own_controller
from troupe.importers.stage.names import name_obstacles, robot_names
from troupe.importers.stage.notes import Note, Notes
from troupe.importers.stage.ports import check_addresses, in_order_of_ports, ports_of
from troupe.importers.stage.robots import Robot, robot_of, said_of
from troupe.importers.stage.sensing import SENSORS
from troupe.importers.stage.surroundings import Standing, Surroundings, standing, surroundings_of
from troupe.importers.stage.syntax import Entity, read_file
from troupe.importers.stage.text import Block, Line, Node, dump
from troupe.importers.stage.things import TYPES, Thing, is_movable, things_in
from troupe.importers.stage.tokens import Place, StageError

CLIENT = "client"
"""The controller of robots that a driver table serves."""

ENDLESS = 600.0
"""Simulated seconds of a world that Stage would run for ever."""


@dataclass(frozen=True)
class Converted:
    """The world file's text, images that go beside it, and what was not carried over."""

    text: str
    images: dict[Path, Bools]
    notes: list[Note]


@dataclass
class _Source:
    """What is converted, and what is known about it so far."""

    world: str
    output: Path
    root: Entity
    notes: Notes = field(default_factory=Notes)
    images: dict[Path, Bools] = field(default_factory=dict)

    @property
    def folder(self) -> str:
        return os.path.dirname(self.world)

    def short(self, place: Place) -> str:
        """FILE:LINE from the world file's folder."""
        return f"{os.path.relpath(place.file, self.folder or '.')}:{place.line}"


def convert(world: str, cfg: str | None, output: Path) -> Converted:
    """Convert a world file of Stage's, and the driver table that goes with it.

    `output`: where the text will be written; the map's name starts at its folder. Nothing is
    written here. Raises StageError for files that Stage or Player could not use either.
    """
    source = _Source(world, output, read_file(world, TYPES))
    notes, root = source.notes, source.root
    units = values.units_of(root)
    things = things_in(root, units, notes)
    everything = [thing for top in things for thing in _walked(top)]
    movers = [thing for thing in everything if thing.entity.type == "position"]
    table = read_table(cfg, movers, notes) if cfg is not None else None
    scanners = table.scanners if table is not None else None
    robots = [robot_of(thing, units, source.folder, scanners, notes) for thing in movers]
    still: list[Standing] = []
    moving: list[tuple[dict[str, Any], Place]] = []
    for thing in everything:
        entity = thing.entity
        if entity.type == "position":
            continue
        if entity.type != "model":
            _note_lone(thing, notes)
        elif is_movable(thing):
            moving += movable_of(thing, source.folder, notes)
        else:
            one = standing(thing, source.folder, movers, notes)
            still += [one] if one is not None else []
    if table is not None:
        robots = in_order_of_ports(robots, table)
        check_addresses(table, robots, ports_of(table), notes)
    surroundings = surroundings_of(
        still, [robot.thing for robot in robots], [data for data, _ in moving], notes
    )
    surroundings.obstacles += moving
    block = _world(source, surroundings, robots, table)
    note_leftovers([root], notes)
    text = _heading(source, cfg) + dump(block) + "\n"
    listed = notes.listed()
    return Converted(text, source.images, listed)


def _walked(thing: Thing) -> list[Thing]:
    """The thing and what stands on it; what can move, with all that it carries, is one thing."""
    if thing.entity.type == "position" or is_movable(thing):
        return [thing]
    return [thing, *(one for child in thing.children for one in _walked(child))]


def _note_lone(thing: Thing, notes: Notes) -> None:
    """A thing that is neither robot nor surroundings."""
    entity = thing.entity
    told = said_of(entity)
    entity.used |= set(entity.properties)
    what = f"{entity.word} {thing.name}"
    if entity.type in (*SENSORS, "gripper"):
        notes.lost(entity.place, f"{what}: a sensor or gripper needs a robot to sit on")
    else:
        notes.lost(entity.place, f"{what}: there is no {entity.type} here{told}")


def _heading(source: _Source, cfg: str | None) -> str:
    files = os.path.basename(source.world) + (f" and {os.path.basename(cfg)}" if cfg else "")
    return f"# Imported from {files}, files of Stage and Player.\n\n"


def _world(
    source: _Source, surroundings: Surroundings, robots: Sequence[Robot], table: Table | None
) -> Block:
    """The whole file as blocks of lines."""
    root, notes = source.root, source.notes
    block: dict[str, Node] = {}
    if "name" in root.properties:
        block["name"] = Line(values.text(root, "name", ""), _from(source, root, "name"))
    frame = surroundings.frame
    around = source.short(frame.thing.entity.place) if frame else "room around all that there is"
    block["size"] = Line(list(surroundings.size), around)
    block["origin"] = Line(surroundings.origin, "Stage's origin")
    quit_time = values.number(root, "quit_time", 0.0)
    if quit_time > 0:
        block["duration"] = Line(quit_time, _from(source, root, "quit_time"))
        block["until"] = Line("duration")
    else:
        block["duration"] = Line(ENDLESS, "s; Stage would run for ever")
        if table is None:
            block["until"] = Line("duration")
    interval = values.number(root, "interval_sim", 100.0) / 1000.0
    if interval <= 0:
        raise StageError(root.properties["interval_sim"].place, "interval_sim must be above 0")
    block["clock"] = Line({"interval": interval}, _from(source, root, "interval_sim"))
    block["boundary"] = Line(None)
    if frame is not None and frame.has_boundary and frame.is_wall:
        wall = {"color": frame.color, "height": height_of(frame.rise)["height"]}
        block["boundary"] = Line(wall, source.short(frame.thing.entity.place))
    if surroundings.plans:
        block["map"] = _map(source, surroundings)
    called = robot_names([robot.thing for robot in robots], notes)
    if surroundings.obstacles:
        block[" obstacles"] = Line(None)
        block["obstacles"] = [
            Line(data, source.short(place))
            for data, place in name_obstacles(surroundings.obstacles, called, notes)
        ]
    if robots:
        names = iter(called)
        models, model_of = _models(source, robots, table)
        block[" models"] = Line(None)
        block["models"] = models
        block[" robots"] = Line(None)
        block["robots"] = [
            Line(
                {
                    "name": next(names),
                    "model": model_of[robot.key],
                    "pose": posed(robot.thing.pose),
                    "controller": CLIENT
                    if table is not None and robot.thing.name in table.robots
                    else own_controller(robot.thing.entity, notes),
                },
                source.short(robot.place),
            )
            for robot in robots
        ]
    if table is not None:
        if table.robots:
            waits = "each robot waits for its Player program; or name a program or command here"
            block[" controllers"] = Line(None)
            block["controllers"] = {CLIENT: Line({"external": True}, waits)}
        block[" player"] = Line(None)
        block["player"] = Line(ports_of(table).data)
    return {key if not key.startswith(" ") else " " * (i + 1): node
            for i, (key, node) in enumerate(block.items())}  # fmt: skip


def _from(source: _Source, entity: Entity, *keys: str) -> str:
    """The line of the first of these properties or entities within that there is."""
    for key in keys:
        found = entity.properties.get(key) or next(
            (child for child in entity.children if child.type == key), None
        )
        if found is not None:
            return source.short(found.place)
    return ""


def _models(
    source: _Source, robots: Sequence[Robot], table: Table | None
) -> tuple[dict[str, Node], dict[str, str]]:
    """One model for all robots that are equal; the model's name by a robot's key."""
    models: dict[str, Node] = {}
    model_of: dict[str, str] = {}
    for robot in robots:
        if robot.key in model_of:
            continue
        name, number = robot.stem, 2
        while name in models:
            name, number = f"{robot.stem}_{number}", number + 1
        model_of[robot.key] = name
        model: dict[str, Node] = {
            "body": Line(robot.body, _from(source, robot.thing.entity, "size", "block")),
            "drive": Line(
                robot.drive, _from(source, robot.thing.entity, "velocity_bounds", "drive")
            ),
        }
        model |= {key: Line(value) for key, value in robot.rest.items()}
        if table is not None and table.simulation and robot.drive is not None:
            model["simulation"] = Line("full", "as Stage's simulation:0")
        for key, parts in (("sensors", robot.sensors), ("actuators", robot.grippers)):
            if parts:
                model[key] = [Line(one.data, source.short(one.place)) for one in parts]
        models[name] = model
    return models, model_of


def _map(source: _Source, surroundings: Surroundings) -> Line:
    """The floorplans as one image: Stage's own where it can be used as it is."""
    notes = source.notes
    largest = max(surroundings.plans, key=lambda one: one.plan.size[0] * one.plan.size[1])  # type: ignore[union-attr]
    plans = [one.plan for one in surroundings.plans if one.plan is not None]
    place = largest.thing.entity.properties["bitmap"].place
    plan = plans[0]
    drawn = draw(plans, surroundings.corner, surroundings.size)
    if plan.whole and drawn.walls is plan.walls:
        file = os.path.relpath(plan.path, source.output.parent)
    else:
        image = source.output.with_name(f"{source.output.stem}_map.png")
        source.images[image] = drawn.walls
        file = image.name
        notes.differs(
            place,
            f"the bitmap was drawn anew as {file}, {drawn.cell:.4g} m per pixel: Stage cuts a "
            "bitmap to its dark pixels and stretches it to the model's size, we do not",
        )
    data: dict[str, Any] = {
        "file": Path(file).as_posix(),
        "resolution": drawn.cell,
        **largest.look(),
    }
    return Line(data, source.short(place))
