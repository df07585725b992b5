"""Every mistake in a world file is told with its place, what was given and what is allowed."""

from __future__ import annotations

from pathlib import Path

import pytest
from world_texts import HEAD, mistakes_in

from sim.worldfile.mistakes import Mistake, did_you_mean

ONE = "robots: [{model: rover, pose: [5, 4, 0]}]\n"

TABLE = [
    # the top level; a text that begins with a blank line stands alone
    ("sized: [1, 2]", "5:1: sized: unknown key; did you mean size?"),
    ("duraton: 3", "5:1: duraton: unknown key; did you mean duration?"),
    ("zzz: 3", "5:1: zzz: unknown key (allowed: name, size, seed,"),
    ("name: 5", "5:7: name: must be text (given: 5)"),
    ("seed: 1.5", "5:7: seed: must be a whole number (given: 1.5)"),
    ("seed: -1", "5:7: seed: is out of range (given: -1; allowed: 0 or more)"),
    ("duration: 0", "5:11: duration: is out of range (given: 0; allowed: above 0)"),
    ("duration: .nan", "5:11: duration: must be a finite number (given: .nan)"),
    ("duration: .inf", "5:11: duration: must be a finite number (given: .inf)"),
    ("duration: 1e999", "5:11: duration: must be a finite number (given: .inf)"),
    (f"duration: 1{'0' * 350}", "5:11: duration: "),
    ("duration: 1:30", "5:11: duration: must be a number; 1:30 is text in YAML 1.2"),
    ("duration: 90 s", "5:11: duration: must be a number without a unit (given: 90 s)"),
    ("duration: true", "5:11: duration: must be a number (given: true)"),
    ("duration: [1]", "5:11: duration: must be a number (given: [1])"),
    ("duration:", "5:1: duration: must be a number (given: null)"),
    ("until: controller", "5:8: until: unknown choice; did you mean controllers? (given: contr"),
    ("models: 3", "5:1: models: this key stands twice; first in line 2"),
    # size
    ("\nsize: [10]", "2:7: size: must be a list of 2 numbers (given: [10]; allowed: [width, heig"),
    ("\nsize: 10", "2:7: size: must be a list of 2 numbers (given: 10; allowed: [width, height])"),
    ("\nsize: [10, -1]", "2:12: size.1: is out of range (given: -1; allowed: above 0)"),
    ("\nsize: [10, x]", "2:12: size.1: must be a number (given: x)"),
    ("\nsize: [10, 1e-12]", "2:12: size.1: is too small (given: 1e-12; allowed: 1e-09 or more)"),
    ("\nsize: [1e10, 1]", "2:8: size.0: is out of range (given: 10000000000.0; allowed: 1e+09 or"),
    ("\nname: x", "2:1: size: the world needs `size`, or a map that it follows from"),
    # clock
    ("clock: 0.1", "5:8: clock: must be a mapping (given: 0.1)"),
    ("clock: {interval: -1}", "5:19: clock.interval: is out of range (given: -1; allowed: abov"),
    (
        "clock: {physics_step: 0.03}",
        "5:23: clock.physics_step: does not divide `interval` (given: 0.03; allowed: 0.1 over a "
        "whole number, such as 0.025)",
    ),
    ("clock: {physics_step: 1}", "5:23: clock.physics_step: does not divide `interval`"),
    ("clock: {physics_step: 1e-7}", "5:23: clock.physics_step: is too short for `interval`"),
    ("clock: {step: 1}", "5:9: clock.step: unknown key (allowed: interval, physics_step)"),
    # boundary, region, floor
    ("boundary: false", "5:11: boundary: must be a mapping (given: false)"),
    (
        "boundary: {color: redd}",
        "5:19: boundary.color: there is no colour 'redd': did you mean red",
    ),
    ("boundary: {color: #ff0000\n  }", "5:12: boundary.color: must be a colour; an unquoted # be"),
    ("boundary: {color: 0xff0000}", "5:19: boundary.color: must be a colour (given: 16711680;"),
    ("boundary: {color: '#ff00'}", "5:19: boundary.color: '#ff00' is not a colour"),
    ("boundary: {shape: region}", "5:19: boundary.shape: there is no region (given: region"),
    ("region: [[0, 0], [1, 0]]", "5:9: region: a polygon has at least 3 corners (given: 2 corn"),
    ("region: [[0, 0], [4, 0], [1, 1], [0, 4]]", "5:9: region: the polygon is not convex"),
    ("region: [[0, 0], [1, 0], [2, 0]]", "5:9: region: the polygon has no area"),
    ("region: [[0, 0], [1, 0], [1, 0], [0, 1]]", "5:26: region.2: this corner stands twice"),
    ("region: [[0, 0], [1, 0, 0], [0, 1]]", "5:18: region.1: must be a list of 2 numbers"),
    ("region: [[0, 0], [11, 0], [0, 1]]", "5:9: region: a corner lies outside of the world"),
    ("floor: {resolution: 0}", "5:21: floor.resolution: is out of range (given: 0; allowed: ab"),
    # map
    ("map: {file: m.txt}", "5:6: map: a text map needs `cell`, metres per character"),
    ("map: {file: m.png}", "5:6: map: an image map needs `resolution`, metres per pixel"),
    ("map: {file: m.png, resolution: 1, cell: 1}", "5:41: map.cell: a map is a picture with"),
    ("map: {cell: 1}", "5:1: map.file: is missing"),
    ("map: {file: 3, cell: 1}", "5:13: map.file: must be a file's name (given: 3"),
    ("map: {file: m.txt, cell: 1}", "5:13: map.file: "),
    ("map: {file: m.png, resolution: 1}", "5:13: map.file: "),
    # obstacles
    ("obstacles: {a: 1}", "5:12: obstacles: must be a list (given: {a: 1})"),
    ("obstacles: [3]", "5:13: obstacles.0: must be a mapping (given: 3)"),
    ("obstacles: [{pose: [1, 1, 0]}]", "5:13: obstacles.0.shape: is missing (allowed: box, cir"),
    (
        "obstacles: [{shape: bax, pose: [1, 1, 0]}]",
        "5:21: obstacles.0.shape: unknown choice; did you mean box? (given: bax; allowed: box, c",
    ),
    ("obstacles: [{shape: box, pose: [1, 1, 0]}]", "5:13: obstacles.0.size: is missing"),
    ("obstacles: [{shape: circle, radius: 1}]", "5:13: obstacles.0.pose: is missing"),
    (
        "obstacles: [{shape: circle, radius: 1, pose: [1, 1]}]",
        "5:46: obstacles.0.pose: must be a list of 3 numbers (given: [1, 1]; allowed: [x, y, head",
    ),
    (
        "obstacles: [{shape: circle, size: [1, 1], radius: 1, pose: [1, 1, 0]}]",
        "5:29: obstacles.0.size: unknown key (allowed: shape, radius, height, color, mass,",
    ),
    (
        "obstacles: [{shape: circle, radius: 1, pose: [1, 1, 0], movable: yes}]",
        "5:66: obstacles.0.movable: must be true or false; yes is text in YAML 1.2 (given: yes)",
    ),
    # models
    ("\nsize: [1, 1]\nmodels: [1]", "3:9: models: must be a mapping (given: [1])"),
    ("\nsize: [1, 1]\nmodels: {a: 1}", "3:13: models.a: must be a mapping (given: 1)"),
    ("\nsize: [1, 1]\nmodels: {a: {}}", "3:10: models.a.body: is missing"),
    (
        "\nsize: [1, 1]\nmodels: {a b: {body: {shape: circle, radius: 1}}}",
        "3:10: models.a b: cannot be a name (given: a b; allo",
    ),
    ("    bdy: 3", "5:5: models.rover.bdy: unknown key; did you mean body?"),
    ("    drive: {kind: tank}", "5:19: models.rover.drive.kind: unknown choice (given: tank; al"),
    ("    drive: {kind: diferential}", "5:19: models.rover.drive.kind: unknown choice; did you"),
    ("    drive: {max_sped: 1}", "5:13: models.rover.drive.max_sped: unknown key; did you mean "),
    ("    drive: {max-speed: 1}", "5:13: models.rover.drive.max-speed: unknown key; did you mea"),
    ("    drive: {max_speed: fast}", "5:24: models.rover.drive.max_speed: must be a number (gi"),
    ("    drive: {wheelbase: 1}", "5:24: models.rover.drive.wheelbase: only a car has `wheelba"),
    ("    drive: {kind: car, wheelbase: 1}", "5:5: models.rover.drive.max_steering: a car need"),
    (
        "    drive: {kind: car, wheelbase: 1, max_steering: 90}",
        "5:52: models.rover.drive.max_steering: is out of range (given: 90; allowed: below 90)",
    ),
    ("    localization: GPS", "5:19: models.rover.localization: unknown choice; did you mean gp"),
    ("    fiducial: 0", "5:15: models.rover.fiducial: is out of range (given: 0; allowed: 1 or m"),
    (
        "    localization: gps\n    odometry_noise: {slip: 0.1}",
        "6:21: models.rover.odometry_noise: a gps has no odometry to drift",
    ),
    ("    odometry_noise: {slip: -1}", "5:28: models.rover.odometry_noise.slip: is out of range"),
    ("    actuators: [{type: spray}]", "5:24: models.rover.actuators.0.type: unknown choice; did"),
    ("    actuators: [{size: [1, 1]}]", "5:17: models.rover.actuators.0.type: is missing"),
    # sensors
    ("    sensors: {type: laser}", "5:14: models.rover.sensors: must be a list (given: {type: "),
    ("    sensors: [laser]", "5:15: models.rover.sensors.0: must be a mapping (given: laser; all"),
    ("    sensors: [{range: 3}]", "5:15: models.rover.sensors.0.type: is missing (allowed: "),
    ("    sensors: [{type: lazer}]", "5:22: models.rover.sensors.0.type: unknown sensor; did yo"),
    ("    sensors: [{type: 3}]", "5:22: models.rover.sensors.0.type: unknown sensor (given: 3; "),
    ("    sensors: [{type: ./a.py}]", "5:22: models.rover.sensors.0.type: the sensor file cannot"),
    (
        "    sensors: [{type: laser, smaples: 3}]",
        "5:29: models.rover.sensors.0.smaples: unknown key; did you mean samples? (allowed: pose,",
    ),
    (
        "    sensors: [{type: laser, samples: 1}]",
        "5:38: models.rover.sensors.0.samples: is out of range (given: 1; allowed: 2 or more)",
    ),
    (
        "    sensors: [{type: laser, fov: 361}]",
        "5:34: models.rover.sensors.0.fov: is out of range (given: 361; allowed: 360 or less)",
    ),
    (
        "    sensors: [{type: blobfinder, colors: [red, grean]}]",
        "5:48: models.rover.sensors.0.colors.1: there is no colour 'grean': did you mean green",
    ),
    # robots
    ("robots: [{pose: [5, 4, 0]}]", "5:10: robots.0.model: is missing"),
    ("robots: [{model: rover}]", "5:10: robots.0: a robot needs `pose`, or `placement: random`"),
    (
        "robots: [{model: Rovr, pose: [5, 4, 0]}]",
        "5:18: robots.0.model: there is no such model; did you mean rover? (given: Rovr; allowed",
    ),
    (
        "robots: [{model: rover, pose: [5, 4, 0], controller: wandr}]",
        "5:54: robots.0.controller: there is no such controller; did you mean wander? (given: wan",
    ),
    (
        "robots: [{model: rover, pose: [5, 4, 0], controller: ./mine.py}]",
        "5:54: robots.0.controller: a file is named under `controllers`, and here its entry",
    ),
    (
        "robots: [{model: rover, pose: [5, 4, 0], controller: motion}]",
        "5:54: robots.0.controller: there is no such controller (given: motion; allowed: ",
    ),
    (
        "robots: [{model: rover, pose: [5, 4, 0], count: 2}]",
        "5:49: robots.0.count: several robots cannot share a pose (given: count: 2",
    ),
    ("robots: [{model: rover, placement: random, count: 0}]", "5:51: robots.0.count: is out of r"),
    (
        "robots: [{model: rover, pose: [5, 4, 0], placement: random}]",
        "5:53: robots.0.placement: a robot has `pose` or `placement`, not both",
    ),
    (
        "robots: [{model: rover, pose: [5, 4, 0], headings: [0]}]",
        "5:52: robots.0.headings: `headings` goes with `placement`",
    ),
    ("robots: [{model: rover, placement: everywhere}]", "5:36: robots.0.placement: unknown place"),
    (
        "robots: [{model: rover, placement: {same_x: true}}]",
        "5:37: robots.0.placement.same_x: unknown key; did you mean same_y?",
    ),
    (
        "robots: [{model: rover, placement: random, headings: []}]",
        "5:54: robots.0.headings: must not be empty (given: [])",
    ),
    ("robots: [{model: rover, name: a b, pose: [5, 4, 0]}]", "5:31: robots.0.name: cannot be a na"),
    (
        "robots: [{model: rover, pose: [5, 4, .nan]}]",
        "5:38: robots.0.pose.2: must be a finite number (given: .nan)",
    ),
    (
        "robots:\n  - {model: rover, name: a, pose: [5, 4, 0]}\n"
        "  - {model: rover, name: a, pose: [2, 4, 0]}",
        "7:26: robots.1.name: robots.0 has a robot of this name too (given: a; allowed: another",
    ),
    (
        "robots:\n  - {model: rover, name: rover2, pose: [5, 4, 0]}\n"
        "  - {model: rover, count: 2, placement: random}",
        "7:5: robots.1.name: robots.0 has a robot of this name too (given: rover2",
    ),
    (
        "robots: [{model: rover, pose: [0.2, 4, 0]}]",
        "5:31: robots.0.pose: the robot starts in a wall or an obstacle (given: robot rover1 at ",
    ),
    (
        "robots: [{model: rover, pose: [20, 4, 0]}]",
        "5:31: robots.0.pose: the robot starts outside of the world",
    ),
    (
        "robots:\n  - {model: rover, pose: [5, 4, 0]}\n  - {model: rover, pose: [5.5, 4, 0]}",
        "7:26: robots.1.pose: the robot starts in robot rover1",
    ),
    (
        "robots: [{model: rover, placement: {same_y: true, margin: 5}, count: 2}]",
        "5:10: robots.0: 2 robot(s) of model rover do not fit here",
    ),
    (
        "robots: [{model: rover, count: 500, placement: random}]",
        "5:10: robots.0: 500 robot(s) of model rover do not fit here: with those before they need "
        "192.4 m2 of 78.21 (allowed: fewer robots, a smaller margin, or a larger world)",
    ),
    # doors
    ("doors: [{name: s, at: X, model: rover, period: 1}]", "5:23: doors.0.at: must be a place (gi"),
    ("doors: [{name: s, at: S, model: rover, period: 1}]", "5:23: doors.0.at: "),
    ("doors: [{name: s, at: [1, 1], model: rver, period: 1}]", "5:38: doors.0.model: there is no"),
    (
        "doors: [{name: s, at: [1, 1], model: rover, period: 1, controller: none}]",
        "5:68: doors.0.controller: there is no such controller",
    ),
    ("doors: [{name: s, at: [1, 1], model: rover}]", "5:9: doors.0.period: is missing"),
    (
        "doors: [{name: s, at: [1, 1], model: rover, period: 0.25}]",
        "5:53: doors.0.period: is not a whole number of the clock's intervals (given: 0.25; "
        "allowed: a multiple of 0.1, such as 0.2)",
    ),
    (
        "doors: [{name: s, at: [1, 1], model: rover, period: 0.01}]",
        "5:53: doors.0.period: is not a",
    ),
    (
        "doors:\n  - {name: s, at: [1, 1], model: rover, period: 1}\n"
        "  - {name: s, at: [3, 1], model: rover, period: 1}",
        "7:12: doors.1.name: doors.0 has this name too (given: s)",
    ),
    (
        "doors: [{name: rover, at: [1, 1], model: rover, period: 1}]\n" + ONE.strip(),
        "5:16: doors.0.name: a robot from this door would be called as another, rover1",
    ),
    # controllers
    ("controllers: {a: {}}", "5:18: controllers.a: a controller is one of three kinds (given: non"),
    ("controllers: {a: {program: 3}}", "5:28: controllers.a.program: must be text (given: 3)"),
    (
        "controllers: {a: {program: wandr}}",
        "5:28: controllers.a.program: there is no such program; did you mean wander?",
    ),
    ("controllers: {a: {program: ./a.py}}", "5:28: controllers.a.program: there is no such file"),
    ("controllers: {a: {program: ./}}", "5:28: controllers.a.program: is a folder, not a Python"),
    ("controllers: {a: {command: ls -l}}", "5:28: controllers.a.command: must be a list (given: "),
    ("controllers: {a: {command: []}}", "5:28: controllers.a.command: must not be empty"),
    ("controllers: {a: {command: [sh, 3]}}", "5:33: controllers.a.command.1: must be text (given"),
    ("controllers: {a: {command: [./a.out]}}", "5:29: controllers.a.command.0: there is no such "),
    (
        "controllers: {a: {command: [no-such-command]}}",
        "5:29: controllers.a.command.0: no such command is found on PATH (given: no-such-command)",
    ),
    (
        "controllers: {a: {external: true, program: wander}}",
        "5:18: controllers.a: a controller is one of three kinds (given: program and external",
    ),
    ("controllers: {a: {external: true, args: {b: 1}}}", "5:41: controllers.a.args: nobody reads"),
    ("controllers: {a: {program: wander, args: 3}}", "5:42: controllers.a.args: must be a mappi"),
    (
        "controllers: {a: {program: wander, args: {b: {c: 1}}}}",
        "5:46: controllers.a.args.b: an option has no mapping as its value (given: {c: 1}",
    ),
    (
        "controllers: {a: {program: wander, args: {-b: 1}}}",
        "5:43: controllers.a.args.-b: cannot be an option (given: -b",
    ),
    (
        "controllers: {a: {program: wander, args: {b: [true]}}}",
        "5:47: controllers.a.args.b.0: a list repeats its option with each value (given: true",
    ),
    # player
    ("player: {port: 70000}", "5:16: player.port: is out of range (given: 70000; allowed: 65535 o"),
    ("player: {port: x}", "5:16: player.port: must be a whole number (given: x)"),
    ("player: {layout: one}", "5:18: player.layout: unknown choice (given: one; allowed: per_rob"),
    (
        "player: {port: 65530}\nrobots: [{model: rover, count: 7, placement: random}]",
        "5:16: player.port: the last of 7 robots would be at port 65536 (given: 65530; allowed: a",
    ),
]


@pytest.mark.parametrize(("text", "told"), TABLE, ids=[told[:60] for _, told in TABLE])
def test_one_mistake_is_told_once_and_alone(tmp_path: Path, text: str, told: str) -> None:
    found = mistakes_in(tmp_path, (text if text.startswith("\n") else HEAD + text) + "\n")
    assert len(found) == 1, found
    assert found[0].startswith(told), found[0]


def test_a_world_with_more_than_ten_different_mistakes_shows_all_with_their_lines(
    tmp_path: Path,
) -> None:
    text = """\
size: [10, 8]
durration: 4
clock: {interval: 0.1, physics_step: 0.03}
boundary: {color: rde, colour: red}
obstacles:
  - {shape: box, size: [1, -1], pose: [1, 1, 0]}
  - {shape: circle, radius: .nan, pose: [1, 1, 0]}
models:
  rover:
    body: {shape: circle, radius: 0.3}
    drive: {max_sped: 1}
    sensors: [{type: laser, samples: 1, fov: 400}]
  bad: {body: {shape: box}}
robots:
  - {name: a, model: rover, pose: [5, 4, 0]}
  - {name: a, model: rover, pose: [5.1, 4, 0]}
  - {model: rovr, pose: [2, 2, 0], controller: wandr}
  - {model: bad, pose: [2, 2, 0]}
  - {model: rover, count: 3}
  - {model: rover, count: 900, placement: random}
  - {model: rover, pose: [2, 7.9, 0], pose: [3, 3, 0]}
doors:
  - {name: s, at: [3, 6], model: rover, period: 1, contoller: mine}
controllers:
  mine: {program: ./mine.py}
"""
    found = mistakes_in(tmp_path, text)
    expected = [
        "2:1: durration: unknown key",
        "3:38: clock.physics_step: does not divide",
        "4:19: boundary.color: there is no colour",
        "4:24: boundary.colour: unknown key",
        "6:28: obstacles.0.size.1: is out of range",
        "7:29: obstacles.1.radius: must be a finite number",
        "11:13: models.rover.drive.max_sped: unknown key",
        "12:38: models.rover.sensors.0.samples: is out of range",
        "12:46: models.rover.sensors.0.fov: is out of range",
        "13:9: models.bad.body.size: is missing",
        "16:12: robots.1.name: robots.0 has a robot of this name too",
        "16:35: robots.1.pose: the robot starts in robot a",
        "17:13: robots.2.model: there is no such model",
        "17:48: robots.2.controller: there is no such controller",
        "19:5: robots.4: a robot needs `pose`",
        "20:5: robots.5: 900 robot(s) of model rover do not fit",
        "21:26: robots.6.pose: the robot starts in a wall",
        "21:39: robots.6.pose: this key stands twice",
        "23:52: doors.0.contoller: unknown key",
        "25:19: controllers.mine.program: there is no such file",
    ]
    assert [one[: len(begin)] for one, begin in zip(found, expected, strict=False)] == expected
    assert len(found) == len(expected)


def test_a_mistake_that_follows_from_another_is_not_told(tmp_path: Path) -> None:
    text = HEAD + (
        "clock: {interval: x, physics_step: 0.03}\n"
        "robots: [{model: rover, pose: [1, x, 0]}, {model: other, pose: [2, 2, 0]}]\n"
        "map: {file: m.txt, cell: x}\n"
    )
    found = mistakes_in(tmp_path, text)
    assert [one.split(": ")[1] for one in found] == [
        "clock.interval", "robots.0.pose.1", "robots.1.model", "map.cell",
    ]  # fmt: skip


def test_a_mistake_in_a_map_points_into_the_map(tmp_path: Path) -> None:
    (tmp_path / "m.txt").write_text("###\n#.x\n###\n")
    (found,) = mistakes_in(tmp_path, "map: {file: m.txt, cell: 1}\n")
    assert found.startswith(f"{tmp_path / 'm.txt'}:2:3: map.file: ")


def test_a_mistake_without_a_place_is_told_all_the_same() -> None:
    assert str(Mistake((), "is empty", file="f")) == "f: is empty"
    assert str(Mistake(("a", 0), "is wrong", "1", "2")) == "a.0: is wrong (given: 1; allowed: 2)"


@pytest.mark.parametrize(
    ("word", "meant"),
    [("max_sped", "max_speed"), ("MAX_SPEED", "max_speed"), ("max-speed", "max_speed"),
     ("max speed", "max_speed"), ("speed_max", None), ("", None), ("qqq", None)],
)  # fmt: skip
def test_suggestions_are_near_words(word: str, meant: str | None) -> None:
    assert did_you_mean(word, ["kind", "max_speed", "wheelbase"]) == meant
