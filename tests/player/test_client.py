"""The client, against servers that follow a script: what it sends, reads, and keeps."""

import struct

from scripted_server import scripted
from wire_talk import (
    BANNER,
    CMD,
    DATA,
    DATAMODE,
    DEV,
    DRIVERINFO,
    GET_DATA,
    LASER,
    PLAYER,
    POSITION2D,
    REQ,
    RULE,
)

from player import (
    LaserProxy,
    PlayerClient,
    Position2dProxy,
)


def state(x=0.0, stall=0):
    return struct.pack(">6dI", x, 0, 0, 0, 0, 0, stall)


def test_a_round_is_read():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.round((POSITION2D, 1, state(1.5)), time=0.1)
        talk.round((POSITION2D, 1, state(2.5, stall=1)), time=0.2)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        assert robot.banner == "Player v.3.1.1-dev"
        assert base.driver == "stub"
        assert not base.valid
        assert robot.read()
        assert (robot.time, base.time, base.x, base.stall, base.fresh) == (0.1, 0.1, 1.5, False, 1)
        assert robot.read()
        assert (robot.time, base.x, base.stall) == (0.2, 2.5, True)
        assert not robot.read()
        assert not base.fresh
        assert not robot.read()
        assert "closed the connection" in robot.ending


def test_commands_travel_in_one_write_with_the_request_for_data():
    got = []

    def script(talk):
        talk.greet()
        talk.subscribe()
        got.append(talk.sock.recv(4096))  # what one write brought

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        base.set_speed(0.5, 0.25, vy=0.125)
        robot.read()
    command, request = got[0][:68], got[0][68:]
    assert struct.unpack(">6IdII", command[:40])[2:6] == (POSITION2D, 0, CMD, 1)
    assert struct.unpack(">3dI", command[40:]) == (0.5, 0.125, 0.25, 1)
    assert struct.unpack(">6IdII", request) == (0, 0, PLAYER, 0, REQ, GET_DATA, 0.0, 0, 0)


def test_commands_go_before_a_request_and_at_the_end():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.expect(POSITION2D, CMD, 1)
        talk.accept(POSITION2D, 6)
        talk.expect(POSITION2D, CMD, 1)
        talk.expect(POSITION2D, CMD, 3)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        base.set_speed(1.0)
        base.reset_odometry()
        base.set_speed(2.0)
        robot.flush()
        base.set_car(1.0, 0.5)  # goes out when the client is closed


def test_data_that_comes_before_a_reply_is_kept_for_the_next_read():
    def script(talk):
        talk.greet()
        talk.subscribe()
        request = talk.expect(POSITION2D, REQ, 6)
        talk.say(POSITION2D, 0, DATA, 1, state(7.0), 0.5)
        talk.reply(request)
        talk.round((POSITION2D, 1, state(8.0)), time=0.6)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        base.reset_odometry()
        assert not base.valid
        assert robot.read()
        assert (base.x, robot.time) == (8.0, 0.6)


def test_several_proxies_share_a_connection_and_one_subscription_per_device():
    def script(talk):
        talk.greet()
        assert talk.subscribe().payload[8:16] == struct.pack(">2I", POSITION2D, 0)
        assert talk.subscribe().payload[8:16] == struct.pack(">2I", LASER, 0)
        talk.round(
            (POSITION2D, 1, state(3.0)), (LASER, 1, struct.pack(">4f5I", *[0.0] * 4, *[0] * 5))
        )
        closing = talk.subscribe()
        assert closing.payload[8:20] == struct.pack(">3I", POSITION2D, 0, 2)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        first, second = Position2dProxy(robot), Position2dProxy(robot)
        LaserProxy(robot)
        robot.read()
        assert first.x == second.x == 3.0
        first.close()
        second.close()


def test_push_mode_reads_what_has_come():
    def script(talk):
        talk.sock.sendall(BANNER)
        assert talk.accept(PLAYER, DATAMODE).payload == b"\0\0\0\1"
        talk.accept(PLAYER, RULE)
        talk.subscribe()
        talk.say(POSITION2D, 0, DATA, 1, state(1.0), 0.1)
        talk.expect(POSITION2D, CMD, 1)
        talk.say(POSITION2D, 0, DATA, 1, state(2.0), 0.2)

    with scripted(script) as sock, PlayerClient(sock=sock, mode="push") as robot:
        base = Position2dProxy(robot)
        assert robot.read()
        assert (base.x, robot.time) == (1.0, 0.1)
        base.set_speed(1.0)
        assert robot.read()
        assert (base.x, robot.time) == (2.0, 0.2)
        assert not robot.read()


def test_the_device_list_and_drivers_are_told():
    def script(talk):
        talk.greet()
        talk.list_devices((POSITION2D, 0), (LASER, 3))
        request = talk.expect(PLAYER, REQ, DRIVERINFO)
        talk.reply(request, request.payload[:16] + b"\0\0\0\5\0\0\0\5stub\0\0\0\0")

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        devices = robot.devices()
        assert [str(addr) for addr in devices] == ["position2d:0", "laser:3"]
        assert robot.driver(devices[1]) == "stub"


def test_names_that_a_server_gives_can_be_printed():
    """The banner, and drivers' names: no terminal obeys them, and they are one line."""
    evil = b"\x1b[2J\x1b]0;t\x07\xff\n\x9bx"

    def script(talk):
        talk.sock.sendall((b"Player" + evil).ljust(32, b"\0"))
        talk.accept(PLAYER, DATAMODE)
        talk.accept(PLAYER, RULE)
        name = struct.pack(">II", len(evil), len(evil)) + evil + bytes(-len(evil) % 4)
        for subtype, kept in ((DEV, 20), (DRIVERINFO, 16)):
            message = talk.expect(PLAYER, REQ, subtype)
            talk.reply(message, message.payload[:kept] + name)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        written = r"\x1b[2J\x1b]0;t\x07\xff\n\x9bx"
        assert robot.banner == f"Player{written}"
        assert base.driver == robot.driver(base.addr) == written
