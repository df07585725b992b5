"""The same controller gives the same digest however it is connected, and whoever looks on."""

from __future__ import annotations

import os
import random
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.fleet.launching import environment
from sim.result import Result
from tests.patience import PATIENCE
from tests.processes import ROOT
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import ACK, LASER, POSITION2D, PULL, PUSH, Gone, RawClient

SEED = 5
DURATION = 12.0
NAMES = ("one", "two")

CONTROLLER = """
from player import LaserProxy, PlayerClient, Position2dProxy, SimulationProxy, SpeechProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    laser = LaserProxy(robot)
    simulation = SimulationProxy(robot)
    speech = SpeechProxy(robot)
    random, told = robot.rng(), False
    while robot.read():
        ahead = laser.ranges[8:28].min()
        base.set_speed(0.5 if ahead > 1.5 else 0.1, random.uniform(-1, 1))
        if robot.time > 5 and not told:
            simulation.report("ahead", ahead)
            told = True
            speech.say("half way")
        if robot.time > 10 and robot.name == "two":
            break
"""

WORLD = """\
size: [10, 10]
models:
  rover:
    body: {{shape: box, size: [1, 1]}}
    sensors: [{{type: laser, samples: 36, noise: 0.02}}]
    odometry_noise: {{slip: 0.02, turn: 0.02}}
robots:
  - {{name: one, model: rover, pose: [2, 5, 0], controller: mine}}
  - {{name: two, model: rover, pose: [7, 5, 90], controller: mine}}
controllers:
  mine: {controller}
player: {{layout: {layout}}}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the controller is, which finds our packages wherever it is started."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    (tmp_path / "mine.py").write_text(CONTROLLER)
    return tmp_path


def serve(
    folder: Path, controller: str, *, listen: bool = True, layout: str = "per_robot"
) -> Serving:
    path = write_world(folder, WORLD.format(controller=controller, layout=layout))
    return Serving(
        path,
        duration=DURATION,
        seed=SEED,
        listen=("127.0.0.1", 0) if listen else None,
    )


def command(folder: Path) -> str:
    return f'{{command: ["{sys.executable}", "{folder / "mine.py"}"]}}'


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """The result over socket pairs, with no port open."""
    folder = tmp_path_factory.mktemp("pair")
    (folder / "mine.py").write_text(CONTROLLER)
    with serve(folder, "{program: ./mine.py}", listen=False) as run:
        result = run.result()
    assert result.robot("one").properties
    assert result.robot("one").distance > 2
    return result


def check(result: Result, expected: Result) -> None:
    """All that must not depend on how the controllers are connected."""
    assert result.digest == expected.digest
    for robot, other in zip(result.robots, expected.robots, strict=True):
        assert robot.error in (None, other.error)
        for name in ("pose", "distance", "stalls", "contacts", "properties", "said", "devices"):
            assert getattr(robot, name) == getattr(other, name), name


def test_a_command_over_tcp_gives_the_digest_of_the_socket_pair(
    folder: Path, expected: Result
) -> None:
    with serve(folder, command(folder), listen=False) as run:
        result = run.result()
    check(result, expected)
    assert [robot.state for robot in result.robots] == ["running", "finished"]


def test_one_shared_port_gives_the_same_digest(folder: Path, expected: Result) -> None:
    with serve(folder, command(folder), layout="shared") as run:
        result = run.result()
    assert result.robot("two").devices[0] == "position2d:1"
    assert result.digest == expected.digest


def test_clients_that_come_from_outside_give_the_same_digest(
    folder: Path, expected: Result
) -> None:
    with serve(folder, "{external: true}") as run:
        clients = [
            subprocess.Popen(
                [sys.executable, folder / "mine.py"],
                env=os.environ | environment(name, SEED, "127.0.0.1", run.port(name)),
            )
            for name in NAMES
        ]
        result = run.result()
    assert [client.wait(PATIENCE) for client in clients] == [0, 0]
    assert result.digest == expected.digest
    assert [robot.state for robot in result.robots] == ["running", "finished"]


# -- onlookers ----------------------------------------------------------------------------------


class Onlookers:
    """Clients that come and go as they like and command nothing, until the run is over."""

    def __init__(self, run: Serving, seed: int) -> None:
        self.rounds = 0
        self.run = run
        self.random = random.Random(seed)
        self.thread = threading.Thread(target=self.look, daemon=True)
        self.thread.start()

    def look(self) -> None:
        clients: list[RawClient] = []
        while self.run.running:
            try:
                clients.append(self.come())
                while len(clients) > self.random.randrange(6):
                    clients.pop(self.random.randrange(len(clients))).close()
            except (Gone, OSError):
                continue
        for client in clients:
            client.close()

    def come(self) -> RawClient:
        """A new client: pull or push, with the drive or without, in any order."""
        random = self.random
        client = RawClient(self.run.port(random.choice(NAMES)), timeout=1.0)
        pull = random.random() < 0.5
        client.mode(PULL if pull else PUSH)
        for interf in random.sample([POSITION2D, LASER], random.choice([1, 2])):
            client.subscribe(interf)
        if random.random() < 0.3:
            client.mode(random.choice([PULL, PUSH]))
        for _ in range(random.randrange(5)):
            if pull:
                client.round()
            else:
                client.request(POSITION2D, 0, 1)
            self.rounds += 1
        if pull and random.random() < 0.5:
            client.ask()
        return client


@pytest.fixture
def seed(request: pytest.FixtureRequest) -> Iterator[int]:
    return request.param


@pytest.mark.parametrize("seed", range(3), indirect=True)
@pytest.mark.parametrize("kind", ["program", "command"])
def test_onlookers_change_nothing(folder: Path, expected: Result, kind: str, seed: int) -> None:
    controller = "{program: ./mine.py}" if kind == "program" else command(folder)
    with serve(folder, controller) as run:
        onlookers = Onlookers(run, seed)
        result = run.result()
        onlookers.thread.join(PATIENCE)
    assert onlookers.rounds > 10
    check(result, expected)


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="the system does not tell")
def test_an_onlooker_that_is_there_first_is_not_taken_for_the_program(
    folder: Path, expected: Result
) -> None:
    """It subscribes the drive in pull mode and asks, before the program has even connected."""
    (folder / "gate").mkdir()
    gate = socket.create_server(("127.0.0.1", 0))
    late = (
        f"import socket\nsocket.create_connection(('127.0.0.1', {gate.getsockname()[1]})).recv(1)\n"
    )
    (folder / "mine.py").write_text(late + CONTROLLER)
    with serve(folder, command(folder)) as run:
        first = [RawClient(run.port(name)) for name in NAMES]
        for client in first:
            client.mode(PULL)
            client.subscribe(POSITION2D)
            client.ask()
            assert client.receive().type == ACK
        assert first[0].request(POSITION2D, 0, 1).time == 0.0
        assert run.simulation.ticks == 0
        for _ in NAMES:
            gate.accept()[0].close()
        result = run.result()
        for client in first:
            client.close()
    gate.close()
    check(result, expected)
