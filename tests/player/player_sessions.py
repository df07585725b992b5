"""Sessions for tests: past their first words, with devices subscribed."""

from wire_talk import (
    ACK,
    BANNER,
    DATA,
    GET_DATA,
    LASER,
    POSITION2D,
    PULL,
    SYNCH,
    data_mode,
    open_device,
    replace_rule,
)

from player.codes import DeviceAddr
from player.directory import Directory
from player.session import (
    Session,
)

BASE = DeviceAddr(POSITION2D, 0)
SCANNER = DeviceAddr(LASER, 0)
OK, OVERFLOW = 1, 2
A_ROUND = [(ACK, GET_DATA), (DATA, 1), (SYNCH, OK)]


def make(*, patient=False, mode=PULL, devices=(BASE,), rule=False, **kwargs):
    """A session that has said hello, is in `mode` and has subscribed `devices`."""
    directory = Directory({BASE: "wheels", SCANNER: "eye"}, port=6665)
    session = Session(directory, patient=patient, **kwargs)
    session.receive(data_mode(mode))
    if rule:
        session.receive(replace_rule())
    for addr in devices:
        session.receive(open_device(*addr))
    assert session.outgoing().startswith(BANNER)
    return session


def publish(session, *payloads, addr=BASE, time=1.0):
    for payload in payloads:
        session.publish(addr, 1, payload, time)
    session.end_of_round()
