"""What is known for certain about the own rank: bounds on how many robots are above and below.

All robots keep their order by height, so the two numbers never change, and every bound that ever
held holds for good. The rank is known once the bounds meet; what is taken for certain without
having been seen is only who is hidden on one line: see `lined`.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class RankBounds:
    """At least and at most how many of the `robots` are above and below this one."""

    robots: int
    above: tuple[int, int]
    below: tuple[int, int]

    @classmethod
    def unknown(cls, robots: int) -> RankBounds:
        """Nothing is known but the number of robots."""
        return cls(robots, (0, robots - 1), (0, robots - 1))

    @property
    def rank(self) -> int | None:
        """The own rank, 1 for the lowest, once it is certain."""
        return self.below[0] + 1 if self.below[0] == self.below[1] else None

    def narrow(
        self, above: int, below: int, unsure: int, room_above: int, room_below: int
    ) -> str | None:
        """Take in one observation.

        Args:
            above, below: distinct robots known to be above and below.
            unsure: others that are seen, but nearly level.
            room_above, room_below: at most how many unseen robots there is room for.

        Returns:
            None, or what contradicts the number of robots; then nothing was changed.
        """
        others = self.robots - 1
        unseen = others - above - below - unsure
        if unseen < 0:
            return f"there are at least {above + below + unsure + 1} robots, not {self.robots}"
        at_least = max(self.above[0], above), max(self.below[0], below)
        at_most = (
            min(self.above[1], above + unsure + min(unseen, room_above)),
            min(self.below[1], below + unsure + min(unseen, room_below)),
        )
        if sum(at_least) > others:
            return f"there are at least {sum(at_least) + 1} robots, not {self.robots}"
        if sum(at_most) < others:
            return f"there are at most {sum(at_most) + 1} robots, not {self.robots}"
        above_low = max(at_least[0], others - at_most[1])
        below_low = max(at_least[1], others - at_most[0])
        self.above = above_low, others - below_low
        self.below = below_low, others - above_low
        return None
