"""Our client and our server together, in lockstep: over a socket pair, over TCP, with onlookers."""

import socket
import threading
from itertools import pairwise

import pytest
from wire_talk import BANNER, open_device

from player import (
    BlobfinderProxy,
    LaserProxy,
    PlayerClient,
    Position2dProxy,
    SpeechProxy,
    messages,
)
from player.codes import DeviceAddr, Interface
from player.directory import Directory
from player.server import Disconnected, Server
from player.session import Command, Request
from tests.patience import PATIENCE

BASE = DeviceAddr(Interface.POSITION2D, 0)
SCANNER = DeviceAddr(Interface.LASER, 0)
CAMERA = DeviceAddr(Interface.BLOBFINDER, 0)
VOICE = DeviceAddr(Interface.SPEECH, 0)
TICKS = 60


class Stage(threading.Thread):
    """A robot that is where its commands have brought it; the clock waits for its first client."""

    def __init__(self):
        super().__init__()
        self.server = Server()
        self.directory = Directory(dict.fromkeys([BASE, SCANNER, CAMERA, VOICE], "stage"))
        self.said = []
        self.failure = None

    def run(self):
        try:
            self.play()
        except BaseException as error:
            self.failure = error
        finally:
            self.server.close()

    def play(self):
        clock = None
        x = speed = 0.0
        for tick in range(1, TICKS + 1):
            while clock is None or not clock.session.waiting:
                for connection, event in self.server.poll(PATIENCE):
                    if isinstance(event, Command) and event.name == "velocity":
                        speed = event.message["vel"].x
                    elif isinstance(event, Command):
                        self.said.append((tick, event.message["text"]))
                    elif isinstance(event, Request):
                        connection.session.refuse(event)
                    elif isinstance(event, Disconnected) and connection is clock:
                        return
                    if BASE in connection.session.subscribed and clock is None:
                        clock = connection
                self.server.flush()
            x += 0.1 * speed
            self.directory.time = tick / 10
            self.publish(tick, x)
            self.server.flush()

    def publish(self, tick, x):
        state = messages.encode(*BASE[:1], 1, 1, pos=(x, 0, 0), vel=(0, 0, 0), stall=0)
        scan = messages.encode(
            *(6, 1, 1),
            min_angle=-1,
            max_angle=1,
            resolution=1,
            max_range=8,
            ranges=[tick, x, 8],
            intensity=b"",
            id=0,
        )
        blobs = messages.encode(7, 1, 1, width=160, height=120, blobs=[(tick,) + (0,) * 9])
        for connection in self.server.connections:
            for addr, payload in ((BASE, state), (SCANNER, scan), (CAMERA, blobs)):
                connection.session.publish(addr, 1, payload, tick / 10)
            connection.session.end_of_round()


def drive(robot):
    """All readings of a controller whose every command follows from the reading before."""
    base, laser, camera, voice = (
        proxy(robot) for proxy in (Position2dProxy, LaserProxy, BlobfinderProxy, SpeechProxy)
    )
    readings = []
    while robot.read():
        assert base.fresh
        assert laser.fresh
        assert camera.fresh
        readings.append((robot.time, base.x, tuple(laser.ranges), camera.blobs[0].id))
        base.set_speed(1.0 if base.x < 2.0 else -0.5)
        if len(readings) % 20 == 0:
            voice.say(f"reading {len(readings)}")
    return readings


def run(connect, onlooker=False):
    stage = Stage()
    watcher = None
    if onlooker:  # pushed to, never reads
        address = stage.server.listen("127.0.0.1", 0, stage.directory)
        watcher = socket.create_connection(address, timeout=PATIENCE)
        watcher.sendall(open_device(*SCANNER))
    client = connect(stage)
    stage.start()
    with client() as robot:
        readings = drive(robot)
    stage.join(PATIENCE)
    if watcher is not None:
        assert watcher.recv(len(BANNER)) == BANNER
        watcher.close()
    if stage.failure is not None:
        raise stage.failure
    return readings, stage.said


def over_a_socket_pair(stage):
    ours, theirs = socket.socketpair()
    stage.server.adopt(ours, stage.directory)
    return lambda: PlayerClient(sock=theirs)


def over_tcp(stage):
    address = stage.server.listen("127.0.0.1", 0, stage.directory)
    return lambda: PlayerClient(*address)


def test_each_read_is_one_tick_and_each_command_counts_in_the_next():
    readings, said = run(over_a_socket_pair)
    assert [time for time, *_ in readings] == [tick / 10 for tick in range(1, TICKS + 1)]
    assert [row[2][0] for row in readings] == list(range(1, TICKS + 1))
    x = 0.0
    for (_, before, *_), (_, after, *_) in pairwise(readings):
        x += 0.1 * (1.0 if before < 2.0 else -0.5)
        assert after == x
    assert said == [(21, "reading 20"), (41, "reading 40")]  # the run is over after reading 60


@pytest.mark.parametrize("onlooker", [False, True])
@pytest.mark.parametrize("connect", [over_a_socket_pair, over_tcp])
def test_a_run_is_the_same_over_tcp_and_with_an_onlooker(connect, onlooker):
    assert run(connect, onlooker) == run(over_a_socket_pair)
