"""How long a client waits, and how much it keeps meanwhile: whatever a server does, both end."""

import itertools
import struct
import threading

import pytest
from scripted_server import scripted
from wire_talk import (
    ACK,
    BANNER,
    CMD,
    DATA,
    DATAMODE,
    DEV,
    GET_DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    REQ,
    RULE,
    SYNCH,
    hear,
    say,
)

from player import (
    LaserProxy,
    PlayerClient,
    PlayerRefused,
    PlayerTimeout,
    Position2dProxy,
)
from player.backlog import Backlog
from player.codes import QUEUE_LIMIT
from player.header import MAX_PAYLOAD, Message
from tests.patience import PATIENCE


def state(x=0.0, stall=0):
    return struct.pack(">6dI", x, 0, 0, 0, 0, 0, stall)


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


@pytest.mark.parametrize("during_a_request", [False, True])
def test_what_is_commanded_after_a_timeout_goes_out_with_the_next_read(during_a_request):
    """Whether the round that was given up is still on its way, or has come meanwhile."""

    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.reply(talk.expect(PLAYER, REQ, GET_DATA))
        if during_a_request:
            request = talk.expect(POSITION2D, REQ, 6)
            talk.say(POSITION2D, 0, DATA, 1, state(4.0), 0.4)
            talk.say(PLAYER, 0, SYNCH, 1)
            talk.reply(request)
            talk.expect(POSITION2D, CMD, 1)
        else:
            talk.expect(POSITION2D, CMD, 1)
            talk.say(POSITION2D, 0, DATA, 1, state(4.0), 0.4)
            talk.say(PLAYER, 0, SYNCH, 1)
        commanded.set()
        talk.round((POSITION2D, 1, state(5.0)), time=0.5)

    commanded = threading.Event()
    with scripted(script) as sock, PlayerClient(sock=sock, read_timeout=0.01) as robot:
        base = Position2dProxy(robot)
        with pytest.raises(PlayerTimeout, match="data"):
            robot.read()
        robot.read_timeout = robot.timeout = PATIENCE
        if during_a_request:
            base.reset_odometry()
        base.set_speed(0.0)
        assert robot.read()
        assert base.x == 4.0
        assert commanded.wait(PATIENCE)
        assert robot.read()
        assert base.x == 5.0


class Flood:
    """A socket whose other end answers, and says `message` whenever it is listened to."""

    def __init__(self, message, answers):
        self.message = message
        self.answers = answers
        self.ready = BANNER
        self.heard = 0

    def sendall(self, data):
        for request in hear(data)[0]:
            if request.type == REQ and request.subtype in self.answers:
                payload = request.payload[:20] + bytes(8) if request.subtype == DEV else b""
                self.ready += say(request.interf, 0, ACK, request.subtype, payload)

    def recv(self, size):
        self.heard += 1
        assert self.heard < 1000, "the client listens for ever"
        data, self.ready = self.ready or self.message * 10, b""
        return data

    def settimeout(self, seconds):
        """There is always something to be had."""

    def fileno(self):
        return -1

    def close(self):
        """Nothing is open."""


@pytest.fixture
def _a_second_at_each_look(monkeypatch):
    """The client's clock goes on by a second whenever it looks at it."""
    seconds = itertools.count()
    monkeypatch.setattr("player.link.monotonic", lambda: float(next(seconds)))


LOOKS = 5.0
"""Seconds of that clock."""

FLOODS = [
    pytest.param(say(POSITION2D, 0, DATA, 1, bytes(52)), id="data"),
    pytest.param(say(PLAYER, 0, SYNCH, 1), id="synch"),
    pytest.param(say(POSITION2D, 0, ACK, 5), id="replies"),
]


@pytest.mark.usefixtures("_a_second_at_each_look")
@pytest.mark.parametrize("message", FLOODS)
def test_a_server_that_never_stops_talking_holds_no_request_past_its_time(message):
    with PlayerClient(sock=Flood(message, {DATAMODE, RULE, DEV}), timeout=LOOKS) as robot:
        base = Position2dProxy(robot)
        with pytest.raises(PlayerTimeout, match="reset_odometry"):
            base.reset_odometry()


@pytest.mark.usefixtures("_a_second_at_each_look")
def test_a_server_that_never_ends_its_round_holds_no_read_past_its_time():
    message = say(POSITION2D, 0, DATA, 1, bytes(52))
    answers = {DATAMODE, RULE, DEV, GET_DATA}
    with PlayerClient(sock=Flood(message, answers), timeout=LOOKS, read_timeout=LOOKS) as robot:
        Position2dProxy(robot)
        with pytest.raises(PlayerTimeout, match="data"):
            robot.read()


@pytest.mark.usefixtures("_a_second_at_each_look")
def test_a_banner_byte_by_byte_holds_no_client_past_its_time():
    class Drip(Flood):
        def recv(self, size):
            self.heard += 1
            return BANNER[self.heard - 1 : self.heard]

    with pytest.raises(PlayerTimeout, match="the banner"):
        PlayerClient(sock=Drip(b"", set()), timeout=LOOKS)


def test_what_a_client_keeps_while_it_waits_for_a_reply_is_bounded():
    def script(talk):
        talk.greet()
        talk.subscribe()
        request = talk.expect(POSITION2D, REQ, 6)
        for number in range(3 * QUEUE_LIMIT):
            talk.say(POSITION2D, 0, DATA, 1, state(number), number)
        talk.reply(request)
        talk.round((POSITION2D, 1, state(-1.0)))

    class Counting(Position2dProxy):
        taken = ()

        def take(self, subtype, payload, time):
            self.taken += (time,)

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base = Counting(robot)
        base.reset_odometry()
        assert robot.read()
        newest = list(range(2 * QUEUE_LIMIT, 3 * QUEUE_LIMIT))
        assert list(base.taken) == [*newest, 1.0]


def test_what_is_kept_is_bounded_in_bytes_too():
    backlog = Backlog()
    large = Message(0, 0, LASER, 0, DATA, 1, 0.0, 0, bytes(MAX_PAYLOAD))
    for number in range(9):
        backlog.add(large._replace(seq=number))
    kept, ended = backlog.take()
    assert [message.seq for message in kept] == [7, 8]
    assert not ended
    assert backlog.dropped == 7
    for number in range(9):
        backlog.add(large._replace(seq=number))
        if number == 5:
            backlog.end_round()
    assert [message.seq for message in backlog.take()[0]] == []
    assert [message.seq for message in backlog.take()[0]] == [7, 8]


def test_a_server_that_hears_nothing_holds_no_command_past_its_time():
    done = threading.Event()

    def script(talk):
        talk.greet()
        talk.subscribe()
        assert done.wait(PATIENCE)

    with scripted(script) as sock, PlayerClient(sock=sock, timeout=0.05) as robot:
        base = Position2dProxy(robot)

        def command_for_ever():
            while True:
                base.set_speed(1.0)
                robot.flush()

        with pytest.raises(PlayerTimeout, match="took nothing"):
            command_for_ever()
        assert "took nothing" in robot.ending
        done.set()


@pytest.mark.parametrize("seconds", [1e7, 1e30, float("inf")])
def test_a_limit_longer_than_the_system_can_keep_is_none(seconds):
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.reply(talk.expect(POSITION2D, REQ, 5))
        for _ in range(3):  # the first ones are read slowly, familiar ones by the quick way
            talk.round((POSITION2D, 1, state(1.0)))

    with (
        scripted(script) as sock,
        PlayerClient(sock=sock, timeout=seconds, read_timeout=None) as robot,
    ):
        base = Position2dProxy(robot)
        base.set_odometry(1, 2, 3)
        for _ in range(3):
            assert robot.read()
