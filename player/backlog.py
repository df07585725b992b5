"""Data that came while a reply was waited for: kept for the next `read`, within bounds."""

from __future__ import annotations

from collections import deque

from player.codes import QUEUE_LIMIT, MessageType
from player.header import HEADER_SIZE, MAX_PAYLOAD, Message

BYTES_LIMIT = 2 * (MAX_PAYLOAD + HEADER_SIZE)
"""Bytes that are kept at the most: two of the largest messages."""

_DATA = int(MessageType.DATA)


class Backlog:
    """Messages of data in their order, and where among them the round that was asked for ends.

    No more is kept than a server keeps for a client: beyond that the oldest goes, as the newest
    says where the robot is. Of a round's ends the first alone counts.
    """

    def __init__(self) -> None:
        self.dropped = 0
        """Messages that had to go."""
        self._of_round: deque[Message] = deque()  # data before the end of the round
        self._later: deque[Message] = deque()
        self._ended = False
        self._size = 0

    def __bool__(self) -> bool:
        """Whether anything is kept, or a round's end has been noted."""
        return bool(self._ended or self._of_round or self._later)

    def add(self, message: Message) -> None:
        """Keeps a message of data."""
        (self._later if self._ended else self._of_round).append(message)
        self._size += HEADER_SIZE + len(message.payload)
        while self._size > BYTES_LIMIT or len(self._of_round) + len(self._later) > QUEUE_LIMIT:
            oldest = (self._of_round or self._later).popleft()
            self._size -= HEADER_SIZE + len(oldest.payload)
            self.dropped += 1

    def end_round(self) -> None:
        """Notes that the round which was asked for ends here."""
        self._ended = True

    def take(self) -> tuple[list[Message], bool]:
        """What the next reading consists of so far, and whether its round is at its end.

        What came after that end stays for the reading after it.
        """
        taken, ended = list(self._of_round), self._ended
        self._of_round, self._later, self._ended = self._later, deque(), False
        self._size = sum(HEADER_SIZE + len(message.payload) for message in self._of_round)
        return taken, ended
