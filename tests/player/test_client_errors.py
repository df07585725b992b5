"""What goes wrong between a client and a server, and what the client says then."""

import threading

import pytest
from scripted_server import scripted
from wire_talk import (
    DEV,
    GET_DATA,
    NACK,
    PLAYER,
    POSITION2D,
    REQ,
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
from tests.patience import PATIENCE


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


@pytest.mark.parametrize(
    "place",
    [("a..b", 6665), ("x" * 300, 6665), ("a\0b", 6665), ("127.0.0.1", 70000), ("127.0.0.1", -1)],
)
def test_what_is_no_address_is_said(place):
    with pytest.raises(PlayerDisconnected):
        PlayerClient(*place)


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
