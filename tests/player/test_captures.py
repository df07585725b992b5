"""Conversations that Player's own clients and server had, read by our code and replayed to it."""

import numpy as np
import pytest
from captured_conversations import (
    BANNER_SIZE,
    NAMES,
    Captured,
    client_messages,
    server_messages,
    stream,
)

from player import messages
from player.codes import BANNER, DeviceAddr
from player.directory import Directory
from player.header import MessageReader
from player.session import Command, Event, Malformed, Request, Session, Subscribed

DATA, CMD, REQ, ACK, SYNCH, NACK = range(1, 7)


def ours(data: bytes) -> list:
    reader = MessageReader()
    reader.feed(data)
    found = []
    while (message := reader.take()) is not None:
        found.append(message)
    assert reader.buffered == 0
    return found


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("direction", ["C", "S"])
def test_every_captured_byte_is_read_and_written_again(name, direction):
    data = stream(name, direction)
    if direction == "S":
        assert data.startswith(BANNER)
        data = data[BANNER_SIZE:]
    again = b""
    for message in ours(data):
        spec = messages.find(message.interf, message.type, message.subtype)
        assert spec is not None
        payload = spec.encode(spec.decode(message.payload))
        assert payload == message.payload
        again += message._replace(payload=payload).encode()
    assert again == data


def test_captured_readings_make_sense():
    scans = [m for m in server_messages("pull_r0") if (m.interf, m.type) == (6, DATA)]
    assert len(scans) == 52
    for message in scans:
        scan = messages.decode(6, DATA, 1, message.payload)
        assert scan["ranges"].shape == (180,)
        assert np.all((scan["ranges"] > 0) & (scan["ranges"] <= scan["max_range"]))
    blobs = [m for m in server_messages("pull_r0") if (m.interf, m.type) == (7, DATA)]
    for message in blobs:
        for blob in messages.decode(7, DATA, 1, message.payload)["blobs"]:
            assert blob["left"] <= blob["right"] < 161
            assert blob["top"] <= blob["bottom"] < 121


def directory_of(name: str) -> Directory:
    """The devices that the captured server said it has, with its address."""
    drivers = {}
    listed = []
    for message in server_messages(name):
        if message.interf == 1 and message.type == ACK and message.subtype in (2, 3):
            values = messages.decode(1, ACK, message.subtype, message.payload)
            addr = values["addr"]
            drivers[DeviceAddr(addr.interf, addr.index)] = values["driver"]
        elif (message.interf, message.type, message.subtype) == (1, ACK, 1):
            rows = messages.decode(1, ACK, 1, message.payload)["devices"]
            listed = [DeviceAddr(int(row[2]), int(row[3])) for row in rows]
    port = server_messages(name)[0].robot
    order = listed or list(drivers)
    return Directory({addr: drivers.get(addr, "") for addr in order}, port=port)


def rounds(name: str) -> list[tuple[list[Captured], list[Captured]]]:
    """The conversation cut after each reply: client's messages, server's messages."""
    client = client_messages(name)
    found = []
    group: list[Captured] = []
    for message in server_messages(name):
        group.append(message)
        is_data_ack = (message.interf, message.type, message.subtype) == (1, ACK, 4)
        if message.type == DATA or is_data_ack:
            continue
        sent = []
        while not sent or sent[-1].type != REQ:
            sent.append(client.pop(0))
        found.append((sent, group))
        group = []
    return found


class Devices:
    """Answers requests with what the captured server answered."""

    def __init__(self, session: Session) -> None:
        self.session = session

    def handle(self, event: Event, reply: Captured) -> None:
        if not isinstance(event, Request):
            assert not isinstance(event, Malformed)
        elif reply.type == NACK:
            self.session.refuse(event, time=reply.time)
        else:
            spec = messages.find(reply.interf, ACK, reply.subtype)
            values = spec.decode(reply.payload) if reply.payload else None
            self.session.acknowledge(event, values, time=reply.time)


@pytest.mark.parametrize("name", ["pull_r0", "pull_r2_6666", "push_r1"])
@pytest.mark.parametrize("patient", [False, True])
def test_players_clients_get_the_same_conversation_from_us(name, patient):
    directory = directory_of(name)
    session = Session(directory, patient=patient)
    devices = Devices(session)
    assert session.outgoing() == BANNER
    for sent, expected in rounds(name):
        reply = next(m for m in expected if m.type in (ACK, NACK))
        directory.time = reply.time
        for message in expected:
            if message.type == DATA:
                addr = DeviceAddr(message.interf, message.index)
                assert addr in session.subscribed
                session.publish(addr, message.subtype, message.payload, message.time)
        session.end_of_round()
        early = session.outgoing()  # in push mode, data does not wait for the reply
        events = session.receive(b"".join(m.raw for m in sent))
        for event in events:
            devices.handle(event, reply)
        assert [e.subtype for e in events if isinstance(e, Command)] == [
            m.subtype for m in sent if m.type == CMD
        ]
        told = ours(early + session.outgoing())
        assert len(told) == len(expected)
        for mine, theirs in zip(told, expected, strict=True):
            if theirs.type == SYNCH:  # Player's time and seq are memory that nobody has written
                assert mine[:6] == theirs[:6]
            else:
                assert mine.encode() == theirs.raw


def test_every_request_of_the_c_client_has_one_reply_of_its_kind():
    """Also where Player gave two replies (laser SET_CONFIG) or none (log, unknown devices)."""
    name = "misc_c_client"
    directory = directory_of(name)
    session = Session(directory)
    session.outgoing()
    commands = []
    for sent in client_messages(name):
        for event in session.receive(sent.raw):
            if isinstance(event, Request):
                session.refuse(event)
            elif isinstance(event, Command):
                commands.append(event.name)
            else:
                assert not isinstance(event, Malformed)
        replies = ours(session.outgoing())
        if sent.type == CMD:
            assert replies == []
            continue
        assert len(replies) == 1
        assert (replies[0].interf, replies[0].index, replies[0].subtype) == (
            sent.interf,
            sent.index,
            sent.subtype,
        )
        assert replies[0].seq == sent.seq
    assert commands.count("pause") == 1
    assert {"velocity", "position", "car", "velocity_heading", "polygon"} <= set(commands)


def test_player_refuses_what_we_refuse():
    """Subscriptions of the C client: one device does not exist, and the reply says so alike."""
    theirs = [m for m in server_messages("misc_c_client") if (m.interf, m.subtype) == (1, 3)]
    session = Session(directory_of("misc_c_client"))
    session.outgoing()
    mine = []
    subscribed = []
    for sent in client_messages("misc_c_client"):
        if (sent.interf, sent.subtype) == (1, 3):
            subscribed += [e for e in session.receive(sent.raw) if isinstance(e, Subscribed)]
            mine += ours(session.outgoing())
    assert [m.type for m in mine] == [m.type for m in theirs]
    assert [m.payload for m in mine] == [m.payload for m in theirs]
    assert sum(m.type == NACK for m in mine) == 1
    opened = {messages.decode(1, m.type, 3, m.payload)["addr"][2:] for m in mine if m.type == ACK}
    assert {event.addr for event in subscribed} == opened
