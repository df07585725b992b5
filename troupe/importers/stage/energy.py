"""Stage's energy: what robots draw from their batteries, and what charges them."""

from __future__ import annotations

from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import Thing

BASE, DRIVING = 1.0, 10.0
"""What a robot draws in Stage: watts always, and at 1 m/s or 1 rad/s for each kilogram."""
SENSORS = {"ranger": 0.2, "blobfinder": 2.0, "bumper": 0.1}
"""Watts of a sensor while it is read; of a ranger, of each of its sensors."""


def battery_of(robot: Thing, notes: Notes) -> dict[str, Any]:
    """The `battery` of a robot on which or on whose parts one is told, else nothing."""
    packs = [thing.entity for thing in robot.all() if stored(thing.entity) is not None]
    if not packs:
        return {}
    entity = packs[0]
    charge = stored(entity)
    capacity = told(entity, "joules_capacity", "kjoules_capacity", default=charge)
    if min(charge or 0.0, capacity or 0.0) < 0.0:
        notes.differs(entity.place, "a battery that never runs down is none here")
        return {}
    if not capacity:
        return {}
    idle = BASE + sum(draws(thing.entity, notes) for thing in robot.all() if thing is not robot)
    mass = values.number(robot.entity, "mass", 0.0)
    intake = max(values.number(thing.entity, "take_watts", 0.0) for thing in robot.all())
    battery = {
        "capacity": capacity,
        **({} if charge == capacity else {"charge": min(charge or 0.0, capacity)}),
        "idle": idle,
        **({"driving": DRIVING * mass, "turning": DRIVING * mass} if mass > 0.0 else {}),
        "intake": max(intake, 0.0),
    }
    return {"battery": battery}


def charger_of(thing: Thing, notes: Notes) -> dict[str, Any]:
    """The `charger` of a model that gives energy, or of what is upon it if that moves with it."""
    watts = values.number(thing.entity, "give_watts", 0.0)
    if watts <= 0.0:
        return {}
    charge = stored(thing.entity)
    if charge is not None and charge >= 0.0:
        notes.differs(thing.entity.place, "a charger never runs out here")
    return {"charger": watts}


def draws(entity: Entity, notes: Notes) -> float:
    """The watts of a part of a robot."""
    if entity.type in SENSORS:
        if "watts" in entity.properties:
            entity.used.add("watts")
            notes.unneeded(entity.properties["watts"].place, "watts: Stage sets a sensor's itself")
        parts = [child for child in entity.children if child.type == "sensor"]
        return SENSORS[entity.type] * (len(parts) if entity.type == "ranger" else 1)
    return max(0.0, values.number(entity, "watts", 0.0)) if entity.type == "model" else 0.0


def stored(entity: Entity) -> float | None:
    """The joules in a model's battery; None where there is none."""
    empty = told(entity, "joules_capacity", "kjoules_capacity")
    return told(entity, "joules", "kjoules", default=None if empty is None else 0.0)


def told(
    entity: Entity, joules: str, kilojoules: str, default: float | None = None
) -> float | None:
    """A quantity that may be told in joules or in thousands of them; the latter count."""
    found = values.numbers(entity, joules)
    thousands = values.numbers(entity, kilojoules)
    if thousands is not None:
        return 1000.0 * thousands[0]
    return default if found is None else found[0]
