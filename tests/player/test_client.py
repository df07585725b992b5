"""The client, against servers that follow a script: what it sends, waits for, and complains of."""

import os
import socket
import struct
import threading

import numpy as np
import pytest
from scripted_server import PATIENCE, scripted, scripted_port
from wire_talk import (
    BANNER,
    CMD,
    DATA,
    DATAMODE,
    DEV,
    DRIVERINFO,
    GET_DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    REQ,
    RULE,
    SYNCH,
)

from player import (
    LaserProxy,
    PlayerClient,
    PlayerDisconnected,
    PlayerRefused,
    PlayerTimeout,
    Position2dProxy,
    ProtocolError,
    SpeechProxy,
    XdrError,
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
        assert base.x == 0.0
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


# -- what goes wrong, and what is said then


def test_an_absent_device_is_refused_with_those_there_are():
    def script(talk):
        talk.greet()
        request = talk.expect(PLAYER, REQ, DEV)
        talk.reply(request, request.payload[:16] + b"\0\0\0\3" + bytes(8), NACK)
        talk.list_devices((POSITION2D, 0))

    with (
        scripted(script) as sock,
        PlayerClient(sock=sock) as robot,
        pytest.raises(PlayerRefused, match=r"no device laser:2 .*there: position2d:0"),
    ):
        LaserProxy(robot, 2)


def test_an_acknowledged_error_is_a_failed_subscription():
    def script(talk):
        talk.greet()
        request = talk.expect(PLAYER, REQ, DEV)
        talk.reply(request, request.payload[:16] + b"\0\0\0\3" + bytes(8))
        talk.list_devices()

    with (
        scripted(script) as sock,
        PlayerClient(sock=sock) as robot,
        pytest.raises(PlayerRefused, match="there: none"),
    ):
        Position2dProxy(robot)


def test_a_refused_request_names_what_was_refused():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.refuse(POSITION2D, 2)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        with pytest.raises(PlayerRefused, match="motor_power of position2d:0"):
            base.set_motor_power(True)


def test_a_request_times_out_and_its_late_reply_disturbs_nobody():
    """Player's own client is off by one for ever after that."""

    def script(talk):
        talk.greet()
        talk.subscribe()
        late = talk.expect(POSITION2D, REQ, 6)
        request = talk.expect(POSITION2D, REQ, 5)
        talk.reply(late)
        talk.reply(request)
        talk.round((POSITION2D, 1, state(1.0)))

    with scripted(script) as sock, PlayerClient(sock=sock, timeout=None) as robot:
        base = Position2dProxy(robot)
        robot.timeout = 0.01
        with pytest.raises(PlayerTimeout, match=r"within 0\.01 s \(reset_odometry of position2d:0"):
            base.reset_odometry()
        robot.timeout = None
        base.set_odometry(1, 2, 3)
        assert robot.stray == 1
        assert robot.read()


def test_two_replies_to_one_request_disturb_nobody():
    """As Player's rangertolaser driver does when it refuses a configuration."""

    def script(talk):
        talk.greet()
        talk.subscribe()
        request = talk.refuse(LASER, 3)
        talk.reply(request, type_=NACK)
        talk.accept(LASER, 1, bytes(72))

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        laser = LaserProxy(robot)
        with pytest.raises(PlayerRefused):
            laser.request_configuration()
        assert laser.request_geometry().size.length == 0.0


def test_a_round_that_was_given_up_is_read_later():
    def script(talk):
        talk.greet()
        talk.subscribe()
        request = talk.expect(PLAYER, REQ, GET_DATA)
        talk.reply(request)
        talk.expect(POSITION2D, CMD, 1)
        talk.say(POSITION2D, 0, DATA, 1, state(4.0), 0.4)
        talk.say(PLAYER, 0, SYNCH, 1)
        talk.round((POSITION2D, 1, state(5.0)), time=0.5)

    with scripted(script) as sock, PlayerClient(sock=sock, read_timeout=0.01) as robot:
        base = Position2dProxy(robot)
        with pytest.raises(PlayerTimeout, match="data"):
            robot.read()
        base.set_speed(0.0)
        robot.flush()
        robot.read_timeout = None
        assert robot.read()
        assert base.x == 4.0
        assert robot.read()
        assert base.x == 5.0


def test_a_round_that_was_given_up_may_end_during_a_request():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.reply(talk.expect(PLAYER, REQ, GET_DATA))
        request = talk.expect(POSITION2D, REQ, 6)
        talk.say(POSITION2D, 0, DATA, 1, state(4.0), 0.4)
        talk.say(PLAYER, 0, SYNCH, 1)
        talk.reply(request)
        talk.round((POSITION2D, 1, state(5.0)), time=0.5)

    with scripted(script) as sock, PlayerClient(sock=sock, read_timeout=0.01) as robot:
        base = Position2dProxy(robot)
        with pytest.raises(PlayerTimeout):
            robot.read()
        robot.read_timeout = None
        base.reset_odometry()
        assert robot.read()
        assert base.x == 4.0
        assert robot.read()
        assert base.x == 5.0


def test_a_server_that_does_not_answer_the_request_for_data_times_out():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.expect(PLAYER, REQ, GET_DATA)
        with pytest.raises(EOFError):
            talk.hear()

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        Position2dProxy(robot)
        robot.timeout = 0.01
        with pytest.raises(PlayerTimeout, match="did not answer within"):
            robot.read()


def test_a_round_without_data_is_a_reading_too():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.round(time=0.7)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        SpeechProxy(robot)
        assert robot.read()
        assert robot.time == 0.7


def test_reading_without_a_device_is_an_error_not_a_wait_for_ever():
    with (
        scripted(lambda talk: talk.greet()) as sock,
        PlayerClient(sock=sock) as robot,
        pytest.raises(ProtocolError, match="make a proxy"),
    ):
        robot.read()


@pytest.mark.parametrize("said", [b"HTTP/1.1 400 Bad Request\r\n\r\n".ljust(40), b"SSH-2.0-x\r\n"])
def test_a_server_that_is_not_players_is_named_so(said):
    with (
        scripted(lambda talk: talk.sock.sendall(said)) as sock,
        pytest.raises(ProtocolError, match="is no Player server: it said"),
    ):
        PlayerClient(sock=sock)


def test_a_connection_cut_in_a_message_is_not_the_end_of_the_run():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.sock.sendall(b"\0" * 7)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        Position2dProxy(robot)
        with pytest.raises(PlayerDisconnected, match="in the middle of a message"):
            robot.read()


def test_bytes_that_are_no_message_are_an_error():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.sock.sendall(b"\xff" * 40)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        Position2dProxy(robot)
        with pytest.raises(ProtocolError):
            robot.read()


def test_data_that_is_not_the_interfaces_is_an_error_that_names_the_device():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.round((POSITION2D, 1, b"short"))

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        Position2dProxy(robot)
        with pytest.raises(XdrError, match="position2d:0: 5 bytes of state"):
            robot.read()


def test_a_request_after_the_end_says_that_it_is_over():
    def script(talk):
        talk.greet()
        talk.subscribe()

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        assert not robot.read()
        base.set_speed(1.0)  # no error: the loop is about to end
        with pytest.raises(PlayerDisconnected, match="closed the connection"):
            base.reset_odometry()
    with pytest.raises(PlayerDisconnected, match="has been closed"):
        robot.read()
    with pytest.raises(PlayerDisconnected, match="has been closed"):
        base.set_speed(1.0)
    robot.close()


def test_flushing_to_nobody_is_said():
    """A program that only commands, and never reads, is to end as well."""
    done = threading.Event()

    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.sock.close()
        done.set()

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Position2dProxy(robot)
        assert done.wait(PATIENCE)
        base.set_speed(1.0)
        with pytest.raises(PlayerDisconnected, match="closed the connection"):
            robot.flush()
        base.set_speed(1.0)
        robot.flush()


# -- where it connects


def test_over_tcp_by_arguments_and_by_the_environment():
    for use_environment in (False, True):
        with scripted_port(lambda talk: talk.greet()) as (host, port):
            environ = {"PLAYER_HOST": host, "PLAYER_PORT": str(port), "PLAYER_ROBOT": "r1"}
            if use_environment:
                client = PlayerClient(environ=environ)
            else:
                client = PlayerClient(host, port, environ={"PLAYER_FD": "77"})
            assert client.timeout == 5.0  # as Player's own client waits
            assert client.name == ("r1" if use_environment else "")
            assert str(port) in repr(client)
            client.close()


def test_nobody_listening_is_said_with_the_address():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    with pytest.raises(PlayerDisconnected, match=f"127.0.0.1:{port}: .*refused .*is it running"):
        PlayerClient("127.0.0.1", port)


def test_a_server_that_says_nothing_times_out():
    with (
        socket.create_server(("127.0.0.1", 0)) as mute,
        pytest.raises(PlayerTimeout, match="the banner"),
    ):
        PlayerClient(*mute.getsockname(), timeout=0.01)


def test_an_inherited_socket_is_found_taken_once_and_not_handed_on():
    with scripted(lambda talk: talk.greet()) as sock:
        fd = os.dup(sock.fileno())
        os.set_inheritable(fd, True)
        environ = {"PLAYER_FD": str(fd), "PLAYER_ROBOT": "r2", "PLAYER_SEED": "42"}
        robot = PlayerClient(environ=environ)
        assert robot.timeout is None
        assert (robot.name, robot.seed, robot.index) == ("r2", 42, 0)
        assert not os.get_inheritable(fd)
        with pytest.raises(PlayerDisconnected, match="has the robot's socket already"):
            PlayerClient(environ=environ)
        robot.close()
        with pytest.raises(PlayerDisconnected, match=f"PLAYER_FD={fd}"):
            PlayerClient(environ=environ)


def test_proxies_take_the_robots_index_unless_told():
    def script(talk):
        talk.greet()
        assert talk.subscribe().payload[8:16] == struct.pack(">2I", LASER, 3)
        assert talk.subscribe().payload[8:16] == struct.pack(">2I", LASER, 0)

    with scripted(script) as sock:
        environ = {"PLAYER_FD": str(os.dup(sock.fileno())), "PLAYER_INDEX": "3"}
        with PlayerClient(environ=environ) as robot:
            LaserProxy(robot)
            LaserProxy(robot, 0)


@pytest.mark.parametrize(
    ("variable", "value"),
    [("PLAYER_PORT", "port"), ("PLAYER_PORT", "70000"), ("PLAYER_FD", "-1"), ("PLAYER_SEED", "x")],
)
def test_a_variable_that_makes_no_sense_is_named(variable, value):
    with pytest.raises(PlayerDisconnected, match=f"{variable}='{value}'"):
        PlayerClient(environ={variable: value})


def test_a_file_is_not_a_robot(tmp_path):
    with (
        (tmp_path / "file").open("w") as file,
        pytest.raises(PlayerDisconnected, match="is not a socket"),
    ):
        PlayerClient(environ={"PLAYER_FD": str(file.fileno())})


def test_the_random_generator_repeats_by_seed_and_is_one():
    draws = []
    for seed in ("7", "7", "8"):
        with scripted(lambda talk: talk.greet()) as sock:
            environ = {"PLAYER_FD": str(os.dup(sock.fileno())), "PLAYER_SEED": seed}
            with PlayerClient(environ=environ) as robot:
                assert robot.rng() is robot.rng()
                draws.append(robot.rng().random(3))
    assert np.array_equal(draws[0], draws[1])
    assert not np.array_equal(draws[0], draws[2])


def test_the_mode_is_one_of_two():
    with (
        scripted(lambda talk: talk.sock.sendall(BANNER)) as sock,
        pytest.raises(ValueError, match="'pull' or 'push'"),
    ):
        PlayerClient(sock=sock, mode="poll")
