"""A tick's rounds of all clients, put together by one compiled call.

What stands in a round is known until somebody subscribes something else: an acknowledgement, the
messages of each device, and an end. Most of them are of batches that are encoded anyway; devices
that encode their own are asked for it. Who has not asked for a round alone is served the plain way.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from player.codes import DeviceAddr, Interface, MessageType, PlayerRequest
from player.directory import Directory
from player.header import HEADER_SIZE, TIME
from player.server import Connection
from player.telling import ROUND_END
from sim.devices.batch import WORD, Batch
from sim.devices.kernels import write_rounds

if TYPE_CHECKING:
    from sim.devices.device import Device
    from sim.devices.encoding import Encoder

_WORDS = HEADER_SIZE // WORD
_SPARE = 2
"""As much room as is needed is taken so many times: blobs come and go."""


Client = tuple[Connection, Directory, Mapping["Device", DeviceAddr]]
"""Who is told, from which port, and what has been subscribed at which address."""


class Standing(NamedTuple):
    """What a device tells tick by tick: a message of a batch."""

    subtype: int
    encoder: Encoder | Loose
    row: int
    """Of the encoder's: a robot, or a sensor of a group."""


def standing(device: Device) -> Standing | None:
    """What a device tells tick by tick, if that is one message of a batch."""
    find = getattr(device, "standing", None)
    return None if find is None else find()


class Loose:
    """Messages of devices that encode their own: a batch like others, made anew for each tick."""

    rows = None

    def __init__(self) -> None:
        self.told: dict[Device, tuple[int, ...]] = {}
        """The subtypes of what each device tells."""
        self.number = 0  # of messages

    def add(self, device: Device) -> list[Standing] | None:
        """What a device tells from now on; None if that does not travel in whole words."""
        data = list(device.publish())
        if any(len(payload) % WORD for _, payload in data):
            return None
        self.told[device] = tuple(subtype for subtype, _ in data)
        first, self.number = self.number, self.number + len(data)
        return [Standing(subtype, self, first + k) for k, (subtype, _) in enumerate(data)]

    def batch(self, round: int) -> Batch | None:
        """This tick's messages; None if they are not those that were told before."""
        payloads = []
        for device, subtypes in self.told.items():
            found = tuple(device.publish())
            if tuple(subtype for subtype, _ in found) != subtypes:
                return None
            payloads += [payload for _, payload in found]
        ends = np.cumsum([0, *map(len, payloads)])
        if (ends % WORD).any():
            return None
        return Batch(np.frombuffer(b"".join(payloads), np.uint32), ends // WORD)

    def place(self, row: int) -> int:
        """Messages lie as they were added."""
        return row


class Rounds:
    """The rounds of some clients, by connection; `plan` says whose, and what stands in them."""

    def __init__(self) -> None:
        self.standing: dict[Device, Standing | None] = {}  # of the devices that were looked at
        self._told: dict[Device, list[Standing] | None] = {}
        self._loose = Loose()
        self._order: list[Connection] = []
        self._encoders: dict[Encoder | Loose, int] = {}
        self._rows: list[object] = []  # which rows an encoder had
        self._batches: list[Batch | None] = []
        self._out = np.zeros(0, np.uint32)
        self._view = memoryview(b"")

    def plan(self, clients: Iterable[Client], round: int) -> None:
        """Find out whose rounds are to be written, and what stands in them."""
        self.standing.clear()
        self._told.clear()
        self._encoders.clear()
        self._loose = Loose()
        self._order = []
        heads: list[bytes] = []
        acks: list[bytes] = []
        sources: list[int] = []
        places: list[int] = []
        firsts = [0]
        for connection, directory, devices in clients:
            told = self._messages(devices)
            if not told:
                continue
            front = directory.front
            self._order.append(connection)
            acks.append(front(Interface.PLAYER, 0, MessageType.ACK, PlayerRequest.DATA))
            for addr, (subtype, encoder, row) in told:
                if encoder is not self._loose:
                    encoder.batch(round)  # it may find its places now
                heads.append(front(*addr, MessageType.DATA, subtype))
                sources.append(self._encoders.setdefault(encoder, len(self._encoders)))
                places.append(encoder.place(row))
            firsts.append(len(heads))
        self._rows = [encoder.rows for encoder in self._encoders]
        self._batches = [None] * len(self._encoders)
        self._tables = np.zeros((len(self._encoders), 2), np.uint64)
        self._sources = np.array(sources, np.int64)
        self._places = np.array(places, np.int64)
        self._heads = _as_words(heads)
        self._acks = _as_words(acks)
        self._firsts = np.array(firsts, np.int64)
        self._ends = np.zeros(len(acks), np.int64)

    def _messages(
        self, devices: Mapping[Device, DeviceAddr]
    ) -> list[tuple[DeviceAddr, Standing]] | None:
        """What a client is told that has subscribed these; None if that cannot lie in words."""
        messages = []
        for device, addr in devices.items():
            if device not in self._told:
                found = self.standing[device] = standing(device)
                self._told[device] = self._loose.add(device) if found is None else [found]
            told = self._told[device]
            if told is None:
                return None
            messages += [(addr, message) for message in told]
        return messages

    def changed(self, device: Device) -> bool:
        """Whether a device tells something else than when it was looked at."""
        return device in self.standing and self.standing[device] != standing(device)

    def write(self, time: float, round: int) -> Mapping[Connection, memoryview] | None:
        """The rounds of this tick, each to be used before the next; None if they need a new plan.

        Raises what an encoder raises.
        """
        if not self._order:
            return {}
        for number, encoder in enumerate(self._encoders):
            batch = encoder.batch(round)
            if batch is None:
                return None
            if batch is not self._batches[number]:
                self._batches[number] = batch
                self._tables[number] = batch.addresses
            if encoder.rows is not self._rows[number]:
                return None
        stamp = np.frombuffer(TIME.pack(time), np.uint32)
        while True:
            needed = write_rounds(
                self._tables, self._sources, self._places, self._heads, self._firsts,
                self._acks, _END, stamp, self._out, self._ends,
            )  # fmt: skip
            if needed <= len(self._out):
                break
            self._out = np.zeros(_SPARE * needed, np.uint32)
            self._view = self._out.data.cast("B")
        return dict(zip(self._order, self._cut(), strict=True))

    def _cut(self) -> Iterable[memoryview]:
        view, begin = self._view, 0
        for end in (WORD * self._ends).tolist():
            yield view[begin:end]
            begin = end


def _as_words(fronts: list[bytes]) -> np.ndarray[tuple[int, ...], np.dtype[np.uint32]]:
    """Headers with no time and no size yet, (m, 10) words as they travel."""
    data = b"".join(front.ljust(HEADER_SIZE, b"\0") for front in fronts)
    return np.frombuffer(data, np.uint32).reshape(len(fronts), _WORDS)


_END = np.frombuffer(ROUND_END, np.uint32)
