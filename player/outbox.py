"""What waits to be written to one client: data in a queue with replace rules, and replies."""

from __future__ import annotations

from collections.abc import Callable

from player.codes import ANY, BANNER, MessageType, Replace
from player.xdr import Values

MAX_RULES = 256
"""Replace rules that one client may add."""

_DATA = int(MessageType.DATA)

Kind = tuple[int, int, int]
"""Interface, index and subtype of data."""


class Outbox:
    """Data waits in a queue until it is released; what is said goes behind what was released.

    At most `limit` messages wait in the queue; `dropped` counts those that found it full.
    `notify`, if any, is called whenever `take` starts to have something to give; `notify_later`
    in its place, if there is one, where that can wait for what comes after it.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.notify: Callable[[], None] | None = None
        self.notify_later: Callable[[], None] | None = None
        self.dropped = 0
        self.backlog = len(BANNER)
        """Bytes that `take` would give now."""
        self._out: list[bytes] = [BANNER]
        self.queued: dict[int, bytes] = {}
        """Data that waits in the queue, in the order of numbers: to be looked at."""
        self._number = 0
        self._latest: dict[Kind, int] = {}
        self._rules: list[tuple[int, ...]] = []
        self._rule_of: dict[Kind, int] = {}
        self._default = int(Replace.ACCEPT)
        self._closed = False
        self._unhurried = False  # all that is to be written can wait
        self.ignores = False
        """True if some rule may have data ignored."""

    @property
    def idle(self) -> bool:
        """True if the queue is empty, and the next data need not go through it."""
        return not (self.queued or self.dropped or self.ignores)

    def add_rule(self, rule: Values) -> bool:
        """Adds a replace rule, or changes the one with the same pattern; False if it is none."""
        if rule["replace"] not in iter(Replace):
            return False
        row = tuple(rule[name] for name in ("interf", "index", "type", "subtype", "replace"))
        for position, other in enumerate(self._rules):
            if other[:4] == row[:4]:
                self._rules[position] = row
                break
        else:
            if len(self._rules) >= MAX_RULES:
                return False
            self._rules.append(row)
        self._rule_of.clear()
        self.ignores = any(rule[4] == Replace.IGNORE for rule in self._rules)
        return True

    def keep_newest(self) -> None:
        """Newer data takes the place of older data of its kind, where no rule says otherwise."""
        self._default = int(Replace.REPLACE)
        self._rule_of.clear()

    def _find_rule(self, kind: Kind) -> int:
        """What to do with data of that kind: the first rule that matches says."""
        interf, index, subtype = kind
        found = self._default
        for rule in self._rules:
            wanted = zip(rule[:4], (interf, index, _DATA, subtype), strict=True)
            if all(part in (ANY, value) for part, value in wanted):
                found = rule[4]
                break
        self._rule_of[kind] = found
        return found

    def queue(self, kind: Kind, message: bytes) -> None:
        """Puts data into the queue, as the replace rules say, if there is room."""
        queue = self.queued
        self._number += 1
        if self._rules or self._default != Replace.ACCEPT:
            rule = self._rule_of.get(kind)
            if rule is None:
                rule = self._find_rule(kind)
            if rule == Replace.IGNORE:
                return
            if rule == Replace.REPLACE:
                queue.pop(self._latest.get(kind, 0), None)
                self._latest[kind] = self._number
        if len(queue) >= self.limit:
            self.dropped += 1
            return
        queue[self._number] = message

    def say(self, message: bytes) -> None:
        """Lets `message` be written, behind what is said and released already."""
        if self._closed:
            return
        if not self._out or self._unhurried:
            self.wake()
        self._out.append(message)
        self.backlog += len(message)

    def say_later(self, message: bytes) -> None:
        """As `say`; but if nothing else is to be written, it can wait for what comes next."""
        if self._closed:
            return
        if not self._out:
            self._unhurried = True
            if self.notify_later is not None:
                self.notify_later()
        self._out.append(message)
        self.backlog += len(message)

    def wake(self) -> None:
        """Tells the owner that there is something to be written."""
        self._unhurried = False
        if self.notify is not None:
            self.notify()

    def release(self) -> None:
        """Lets all data in the queue be written."""
        if self.queued:
            if not self._out or self._unhurried:
                self.wake()
            chunks = self.queued.values()
            self._out.extend(chunks)
            self.backlog += sum(map(len, chunks))
            self.queued.clear()
            self._latest.clear()

    def take(self) -> bytes:
        """Takes the bytes that are to be written now; b"" if there are none."""
        if not self._out:
            return b""
        data = b"".join(self._out)
        self._out.clear()
        self._unhurried = False
        self.backlog = 0
        return data

    def close(self) -> None:
        """Forgets everything, and keeps nothing from now on."""
        self._closed = True
        self.limit = 0
        self.notify = self.notify_later = None
        self.queued.clear()
        self._latest.clear()
        self._out.clear()
        self.backlog = 0
