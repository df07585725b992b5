"""Sessions under any sequence of requests, data and mode changes, against a model of the rules."""

import struct

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from wire_talk import (
    ACK,
    ASK,
    BANNER,
    DATA,
    DEV,
    GET_DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    PULL,
    PUSH,
    REQ,
    SYNCH,
    data_mode,
    hear,
    open_device,
    replace_rule,
    say,
)

from player.codes import DeviceAddr
from player.directory import Directory
from player.session import Malformed, Request, Session

DEVICES = [DeviceAddr(POSITION2D, 0), DeviceAddr(LASER, 0), DeviceAddr(LASER, 1)]
ABSENT = DeviceAddr(5, 0)


class SessionMachine(RuleBasedStateMachine):
    """What the client has heard is compared with what Player's rules allow at any time."""

    patient = False

    def __init__(self):
        super().__init__()
        self.session = Session(Directory(dict.fromkeys(DEVICES, "any")), patient=self.patient)
        assert self.session.outgoing() == BANNER
        self.mode = PUSH
        self.replacing = False
        self.counts = dict.fromkeys(DEVICES, 0)
        self.number = 0
        self.queued = []  # (device, number) that the client has a right to
        self.in_round = False
        self.asked = False
        self.data_acks_due = 0
        self.due = []  # (interf, index, subtype) of requests without a reply
        self.events = []
        self.unanswered = []

    def tell(self, data):
        for event in self.session.receive(data):
            assert not isinstance(event, Malformed)
            if isinstance(event, Request):
                self.unanswered.append(event)
        self.listen()

    def listen(self):
        """Reads what the session writes, and checks each message against the model."""
        found, rest = hear(self.session.outgoing())
        assert rest == b""
        since_ask = 0
        for message in found:
            where = (message.interf, message.index, message.subtype)
            if message.type == DATA:
                [number] = struct.unpack(">I", message.payload)
                addr = DeviceAddr(message.interf, message.index)
                assert self.queued, "data that nobody is owed"
                assert self.queued.pop(0) == (addr, number), "lost, repeated or out of order"
                since_ask += 1
            elif message.type == SYNCH:
                assert self.mode == PULL
                assert self.asked
                assert since_ask, "a SYNCH without data"
                assert not self.queued, "a SYNCH before the data's end"
                self.asked = False
            elif where == (PLAYER, 0, GET_DATA):
                assert message.type == ACK
                self.data_acks_due -= 1
                assert self.data_acks_due >= 0
            else:
                assert message.type in (ACK, NACK)
                self.due.remove(where)

    def owe(self, addr):
        if not self.counts[addr]:
            return
        if self.replacing:
            self.queued = [entry for entry in self.queued if entry[0] != addr]
        self.queued.append((addr, self.number))

    @rule(addr=st.sampled_from(DEVICES))
    def subscribe(self, addr):
        self.due.append((PLAYER, 0, DEV))
        self.counts[addr] += 1
        self.tell(open_device(*addr))

    @rule(addr=st.sampled_from(DEVICES))
    def unsubscribe(self, addr):
        self.due.append((PLAYER, 0, DEV))
        self.counts[addr] = max(self.counts[addr] - 1, 0)
        self.tell(open_device(*addr, access=2))

    @rule()
    def subscribe_what_is_not_there(self):
        self.due.append((PLAYER, 0, DEV))
        self.tell(open_device(*ABSENT))

    @rule(mode=st.sampled_from([PULL, PUSH]))
    def change_mode(self, mode):
        self.due.append((PLAYER, 0, 5))
        if mode == PUSH:
            self.asked = False
        self.mode = mode
        self.tell(data_mode(mode))

    @precondition(lambda self: not self.queued)
    @rule()
    def replace(self):
        self.due.append((PLAYER, 0, 10))
        self.replacing = True
        self.tell(replace_rule())

    @rule()
    def ask(self):
        self.data_acks_due += 1
        if self.mode == PULL:
            self.asked = True
        self.tell(ASK)

    @rule(addr=st.sampled_from(DEVICES))
    def publish(self, addr):
        self.number += 1
        self.in_round = True
        self.owe(addr)
        self.session.publish(addr, 1, struct.pack(">I", self.number), float(self.number))

    @rule()
    def end_round(self):
        self.in_round = False
        self.session.end_of_round()
        self.listen()
        if self.mode == PUSH or self.asked:
            assert not self.queued, "data kept from a client that is to have it"

    @rule(subtype=st.sampled_from([1, 5, 6, 99]), addr=st.sampled_from([*DEVICES, ABSENT]))
    def request(self, subtype, addr):
        self.due.append((*addr, subtype))
        self.tell(say(*addr, REQ, subtype, bytes(24) if subtype == 5 else b""))

    @precondition(lambda self: self.unanswered)
    @rule(data=st.data(), refuse=st.booleans())
    def answer(self, data, refuse):
        request = data.draw(st.sampled_from(self.unanswered))
        self.unanswered.remove(request)
        if refuse:
            self.session.refuse(request)
        else:
            self.session.acknowledge(request)
        self.listen()

    @invariant()
    def every_request_but_the_open_ones_has_its_reply(self):
        assert sorted(self.due) == sorted((*e.addr, e.subtype) for e in self.unanswered)
        held = 1 if self.patient and self.session.waiting else 0
        assert self.data_acks_due == held

    @invariant()
    def subscriptions_are_the_models(self):
        wanted = {addr: count for addr, count in self.counts.items() if count}
        assert self.session.subscribed == wanted

    @invariant()
    def it_waits_exactly_while_it_has_asked_and_not_been_served(self):
        assert self.session.waiting == self.asked


class PatientSessionMachine(SessionMachine):
    patient = True


TestSessions = SessionMachine.TestCase
TestPatientSessions = PatientSessionMachine.TestCase
TestSessions.settings = settings(max_examples=60, stateful_step_count=40)
TestPatientSessions.settings = TestSessions.settings
