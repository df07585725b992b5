"""Player's driver tables: ports, indices, and which ranger is a laser, as our server has them."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
import yaml

from player import PlayerClient
from tests.patience import PATIENCE
from tests.processes import environment, troupe_command
from troupe.importers.stage import StageError, convert
from troupe.importers.stage.drivers import read_table
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.ports import ports_of, served_at
from troupe.importers.stage.robots import robot_of
from troupe.importers.stage.syntax import read_file
from troupe.importers.stage.things import TYPES, things_in
from troupe.importers.stage.values import Units

DATA = Path(__file__).parent / "data"

WORLD = """
model ( size [20 10 1] boundary 1 )
define eye ranger ( sensor ( samples 90 fov 180 ) )
define ping ranger ( sensor ( ) sensor ( pose [0 0 0 90] ) )
define bot position ( localization "gps" eye ( ) ping ( ) blobfinder ( ) )
bot ( name "a" pose [-5 0 0 0] )
bot ( name "b" pose [0 0 0 0] )
bot ( name "c" pose [5 0 0 0] )
"""


@pytest.fixture
def files(tmp_path: Path):
    def make(cfg: str) -> tuple[str, str, Path]:
        (tmp_path / "w.world").write_text(WORLD)
        (tmp_path / "w.cfg").write_text(cfg)
        return str(tmp_path / "w.world"), str(tmp_path / "w.cfg"), tmp_path / "w.yaml"

    return make


def driver(model: str, *addresses: str) -> str:
    provides = " ".join(f'"{address}"' for address in addresses)
    return f'driver ( name "stage" provides [ {provides} ] model "{model}" )\n'


def to_laser(source: str, target: str) -> str:
    return f'driver ( name "rangertolaser" requires ["{source}"] provides ["{target}"] )\n'


def kinds(data, robot: int) -> list[str]:
    model = data["models"][data["robots"][robot]["model"]]
    return [sensor["type"] for sensor in model["sensors"]]


def test_a_port_for_each_robot_orders_the_robots_by_their_ports(files) -> None:
    cfg = driver("c", "7000:position2d:0") + driver("a", "7001:position2d:0")
    converted = convert(*files(cfg + driver("b", "7002:position2d:0")))
    data = yaml.safe_load(converted.text)
    assert data["player"] == {"port": 7000, "layout": "per_robot"}
    assert [robot["name"] for robot in data["robots"]] == ["c", "a", "b"]
    assert not [note for note in converted.notes if note.place.file.endswith(".cfg")]


def test_one_port_for_all_orders_the_robots_by_their_indices(files) -> None:
    cfg = "".join(
        driver(name, f"position2d:{n}", f"blobfinder:{n}") for n, name in enumerate("bca")
    )
    converted = convert(*files(cfg))
    data = yaml.safe_load(converted.text)
    assert data["player"] == {"port": 6665, "layout": "shared"}
    assert [robot["name"] for robot in data["robots"]] == ["b", "c", "a"]
    assert not [note for note in converted.notes if note.place.file.endswith(".cfg")]


def test_robots_of_the_table_wait_for_their_clients_and_the_others_stand(files) -> None:
    data = yaml.safe_load(convert(*files(driver("b", "position2d:0"))).text)
    assert {robot["name"]: robot["controller"] for robot in data["robots"]} == {
        "b": "client", "a": None, "c": None,
    }  # fmt: skip
    assert data["controllers"] == {"client": {"external": True}}


def test_a_ranger_that_is_turned_into_a_laser_is_a_laser_and_others_stay_rangers(files) -> None:
    cfg = driver("a", "position2d:0", "ranger:0", "ranger:1") + to_laser("ranger:0", "laser:0")
    cfg += driver("b", "6666:position2d:0", "6666:ranger:0", "6666:ranger:1")
    data = yaml.safe_load(convert(*files(cfg)).text)
    assert kinds(data, 0) == ["laser", "ranger", "blobfinder"]
    assert kinds(data, 1) == ["ranger", "ranger", "blobfinder"]


def test_a_device_that_is_elsewhere_here_is_noted_with_both_addresses(files) -> None:
    cfg = driver("a", "position2d:0", "ranger:0", "ranger:1") + to_laser("ranger:0", "laser:0")
    notes = [n.what for n in convert(*files(cfg)).notes if n.place.file.endswith(".cfg")]
    # lasers are served as rangers too, but after the model's own rangers
    assert notes == [
        "6665:ranger:0 of a: at 6665:ranger:1 here",
        "6665:ranger:1 of a: at 6665:ranger:0 here",
    ]


def test_a_table_of_stage_3_asks_for_lasers_and_sonars_by_name(files) -> None:
    converted = convert(*files(driver("a", "position2d:0", "laser:0", "sonar:0")))
    assert kinds(yaml.safe_load(converted.text), 0) == ["laser", "ranger", "blobfinder"]
    assert not [note for note in converted.notes if note.place.file.endswith(".cfg")]


@pytest.mark.parametrize(
    "address",
    ["position2d:0", "6665:position2d:0", "base:6665:position2d:0", "base::6665:position2d:0",
     "base:localhost:6665:position2d:0", ":::position2d:0", "position2d:0 "],
)  # fmt: skip
def test_addresses_are_read_in_all_their_forms(files, address: str) -> None:
    data = yaml.safe_load(convert(*files(driver("a", address))).text)
    assert data["player"]["port"] == 6665


def test_other_drivers_and_interfaces_are_listed(files) -> None:
    cfg = (
        driver("a", "position2d:0", "gripper:0", "ptz:0")
        + 'driver ( name "amcl" provides ["localize:0"] )'
    )
    lost = [str(note) for note in convert(*files(cfg)).notes if note.kind == "lost"]
    assert any("w.cfg:1: ptz: the interface is not served" in line for line in lost)
    assert any("w.cfg:1: gripper: the model has none left" in line for line in lost)
    assert any("w.cfg:2: driver amcl" in line for line in lost)


@pytest.mark.parametrize(
    ("cfg", "words"),
    [
        (driver("a", "position2d"), "no address such as 6665:position2d:0"),
        (driver("a", "position2d:zero"), "no address such as"),
        ('driver ( name "stage" )', "needs provides"),
    ],
)  # fmt: skip
def test_what_player_could_not_use_either_is_a_mistake(files, cfg: str, words: str) -> None:
    with pytest.raises(StageError) as caught:
        convert(*files(cfg))
    assert words in str(caught.value)
    assert "w.cfg:1:" in str(caught.value)


@pytest.mark.parametrize("layout", ["per_robot", "shared"])
def test_a_run_serves_every_device_at_the_address_of_the_table(files, layout: str) -> None:
    """`served_at` repeats the order in which the simulator hands out indices: here it is asked."""
    port = {"per_robot": "{}:", "shared": ""}[layout]
    index = {"per_robot": (0, 0), "shared": (0, 1)}[layout]
    cfg = ""
    for number, name in enumerate("ab"):
        at, n = port.format(6665 + number), index[number]
        wanted = [f"{at}position2d:{n}", f"{at}ranger:{2 * n}", f"{at}ranger:{2 * n + 1}"]
        cfg += driver(name, *wanted) + to_laser(wanted[2], f"{at}laser:{n}")
    world, table_file, output = files(cfg)
    output.write_text(convert(world, table_file, output).text)
    things = things_in(read_file(world, TYPES), Units(), Notes())
    movers = [thing for thing in things if thing.entity.type == "position"]
    table = read_table(table_file, movers, Notes())
    robots = [robot_of(thing, Units(), "", table.scanners, Notes()) for thing in movers]
    meant: dict[int, set[str]] = {}
    for address in served_at(robots, ports_of(table)):
        meant.setdefault(address.port - 6665, set()).add(f"{address.interface}:{address.index}")
    assert devices_of_a_run(output, len(meant)) == [meant[n] for n in range(len(meant))]


def devices_of_a_run(world: Path, ports: int) -> list[set[str]]:
    """The device lists of the first ports of a run of a world whose robots wait for clients."""
    run = subprocess.Popen(
        troupe_command("run", str(world), "--listen", "127.0.0.1:0"),
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert run.stderr is not None
        lists: list[set[str]] = []
        said = ""
        for line in run.stderr:
            said += line
            served = re.search(r"served at 127\.0\.0\.1:(\d+)", line)
            if served:
                with PlayerClient(
                    "127.0.0.1", int(served[1]), timeout=PATIENCE, environ={}
                ) as client:
                    lists.append({str(addr) for addr in client.devices()})
            if len(lists) == ports:
                return lists
        raise AssertionError(f"the run ended with {len(lists)} ports: {said}")
    finally:
        run.terminate()
        run.communicate(timeout=PATIENCE)


@pytest.mark.parametrize(
    ("cfg", "words"),
    [
        (driver("d", "position2d:0"), "position2d of d, which is no robot"),
        (driver("a", "positron:0"), "Player has no interface positron"),
        ('driver ( name "stage" provides ["position2d:0"] )', "which model"),
        (to_laser("ranger:3", "laser:0"), "nobody provides it"),
    ],
)
def test_what_cannot_be_served_is_listed_and_the_rest_goes_on(files, cfg: str, words: str) -> None:
    got = convert(*files(f"{cfg}\n{driver('b', 'position2d:0')}"))
    assert any(words in note.what and note.kind == "lost" for note in got.notes)
    served = [one for one in yaml.safe_load(got.text)["robots"] if one["controller"] == "client"]
    assert [one["name"] for one in served] == ["b"]
