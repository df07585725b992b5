"""Colours that are drawn: the same whenever the seed is, each thing its own."""

from __future__ import annotations

from sim.build import load_data
from sim.scenery import Scenery

WORLD = {
    "size": [9, 9],
    "obstacles": [
        {"shape": "circle", "radius": 0.3, "pose": [k, 8, 0], "color": "random"} for k in (2, 5)
    ],
    "models": {"m": {"body": {"shape": "circle", "radius": 0.2, "color": "random"}}},
    "robots": [{"model": "m", "count": 4, "placement": "random"}],
}


def colors(seed: int) -> list[int]:
    """Of the robots."""
    loaded = load_data(WORLD)
    scenery = Scenery(loaded, seed)
    for spec, pose in zip(loaded.robots, scenery.start_poses, strict=True):
        scenery.add_robot(spec.name, spec.model, loaded.world.models[spec.model], pose)
    return scenery.scene.colors[scenery.surroundings.entities].tolist()


def test_each_robot_has_its_own_and_a_seed_draws_it_again() -> None:
    assert len(set(colors(1))) == 4
    assert colors(1) == colors(1)
    assert set(colors(1)).isdisjoint(colors(2))
    assert all(0 <= color <= 0xFFFFFF for color in colors(3))


def test_obstacles_have_theirs_by_the_worlds_seed() -> None:
    looks = [one.look.color for one in load_data(WORLD).layout.solids[-2:]]
    assert len(set(looks)) == 2
    assert looks == [one.look.color for one in load_data(WORLD).layout.solids[-2:]]
    other = load_data(WORLD | {"seed": 5}).layout.solids[-2:]
    assert looks != [one.look.color for one in other]
