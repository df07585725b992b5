"""Properties that nobody has read: each is named, as lost or as of no use here."""

from __future__ import annotations

from collections.abc import Iterable

from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity, Property

WINDOW = "concerns Stage's window"
UNNEEDED = {
    "threadpool": "a run gives the same result on any number of cores",
    "threads": "a run gives the same result on any number of cores",
    "resolution": "geometry is exact here",
    "map_resolution": "geometry is exact here",
    "interval_real": "`troupe run --realtime FACTOR` holds a run to the clock",
    "speedup": "`troupe run --realtime FACTOR` holds a run to the clock",
    "paused": WINDOW,
    "show_clock": WINDOW,
    "show_clock_interval": WINDOW,
    "confirm_on_quit": WINDOW,
    "debug": WINDOW,
    "alwayson": "what nobody reads costs nothing here",
    "event_queue": "a run gives the same result on any number of cores",
    "localization_origin": "Stage itself does not look at it where the robot has gps",
    "odom": "Stage itself does not look at it any more",
    "lazy": "what nobody reads costs nothing here",
    "polygons": "a model of Stage 2 has polygon[i].points besides",
    "odom_error": "a robot with gps has no odometry",
    "take_watts": "nothing is charged that has no battery",
    "watts": "Stage sets itself what a robot draws, and without a battery nothing is drawn",
    "wheelbase": "only a car has one",
}
"""Why a property can be done without."""

LOST = {
    "friction": "Stage's friction slows what is pushed; here `friction` is Coulomb's coefficient",
    "joules": "only a robot has a battery",
    "joules_capacity": "only a robot has a battery",
    "kjoules": "only a robot has a battery",
    "kjoules_capacity": "only a robot has a battery",
    "give_watts": "only what stands, or can be pushed, charges robots",
    "update_interval": "every device gives data once per clock.interval",
    "fiducial_key": "every finder sees every fiducial (a finder's `ids` can choose)",
    "gripper_return": "a robot is no thing that others push and grip",
    "velocity": "what stands, stands still until it is pushed",
    "mass": "only what moves has a mass",
    "boundary": "a robot has no boundary",
    "colors_count": "there are no colors",
}
"""What is missing with a property."""

LOOKS = {
    "say": "what is said belongs to programs (Player's speech)",
}
"""What only Stage's window shows."""

NO_CHANGE = {
    "alwayson": 0.0,
    "boundary": 0.0,
    "fiducial_key": 0.0,
    "fiducial_return": 0.0,
    "friction": 0.0,
    "gripper_return": 0.0,
    "noblocks": 0.0,
    "obstacle_return": 1.0,
    "ranger_return": 1.0,
    "stack_children": 1.0,
    "update_interval": 100.0,
    "velocity": 0.0,
    "watts": 0.0,
}
"""Values that say no more than the property's absence."""

WINDOW_PREFIXES = ("gui_", "trail_", "show_", "window")


def note_leftovers(entities: Iterable[Entity], notes: Notes) -> None:
    """Note every property of these entities and of those within that is not used."""
    for entity in entities:
        for key, found in entity.properties.items():
            if key not in entity.used:
                _note(entity, key, found, notes)
        if entity.type == "window":
            notes.unneeded(entity.place, f"window: {WINDOW}")
            continue
        note_leftovers(entity.children, notes)


def _note(entity: Entity, key: str, found: Property, notes: Notes) -> None:
    if entity.type == "window":
        return
    default = NO_CHANGE.get(key)
    if default is not None and all(value == default for value in found.values):
        return
    place = found.place
    if key == "ctrl":
        library = str(found.values[0]).split()[0] if found.values else ""
        notes.lost(place, _controller(library))
    elif key in UNNEEDED:
        notes.unneeded(place, f"{key}: {UNNEEDED[key]}")
    elif key.startswith(WINDOW_PREFIXES):
        notes.unneeded(place, f"{key}: {WINDOW}")
    elif key in LOOKS:
        notes.looks(place, f"{key}: {LOOKS[key]}")
    elif key in LOST:
        notes.lost(place, f"{key}: {LOST[key]}")
    else:
        notes.lost(place, f"{key}: no property of {entity.type} that is known here")


OURS = ("wander",)
"""Controllers that come with Stage, and with Troupe under the same name."""


def own_controller(entity: Entity, notes: Notes) -> str | None:
    """The program of ours that drives a robot as the `ctrl` of its model would, if there is one."""
    found = entity.properties.get("ctrl")
    library = str(found.values[0]).split()[0:1] if found is not None and found.values else []
    if found is None or not library or library[0] not in OURS:
        return None
    entity.used.add("ctrl")
    notes.differs(
        found.place, f'ctrl "{library[0]}": Troupe\'s own program of that name drives the robot'
    )
    return library[0]


def _controller(library: str) -> str:
    name = library if library.isidentifier() else "mine"
    return (
        f'ctrl "{library}": a library of Stage, not a program; write a Player client, and name it: '
        f"`controllers: {{{name}: {{program: ./{name}.py}}}}`"
    )
