"""Seeds as they are written: `5`, `0:100` (0 to 99), `0:100:10`, or several between commas."""

from __future__ import annotations

from sim.worldfile.mistakes import Mistake
from troupe.usage import UsageError

LARGEST = (1 << 63) - 1
DIGITS = len(str(LARGEST))
MOST = 10_000_000
"""Seeds of one sweep."""

ALLOWED = "numbers from 0 and ranges FIRST:END, as 0:100 for 0 to 99, between commas"


class Unusable(UsageError):
    """What somebody wrote cannot be used; `mistakes` says why."""

    def __init__(self, *mistakes: Mistake) -> None:
        super().__init__("\n".join(str(mistake) for mistake in mistakes))
        self.mistakes = mistakes


def parse_seeds(text: str) -> list[int]:
    """The seeds that a text stands for, in its order, each once; raises Unusable."""
    seeds: dict[int, None] = {}
    for part in text.split(","):
        numbers = [piece.strip() for piece in part.split(":")]
        if len(numbers) > 3 or not all(p.isascii() and p.isdecimal() for p in numbers):
            raise refused(text, f"`{part.strip()}` is no seed and no range of seeds")
        if any(len(piece.lstrip("0")) > DIGITS for piece in numbers):
            raise refused(text, f"`{part.strip()}` is too large: at most {LARGEST}")
        first, *rest = [int(piece) for piece in numbers]
        chosen = range(first, *rest) if rest and 0 not in rest[1:] else range(first, first + 1)
        if rest and (0 in rest[1:] or not chosen):
            raise refused(text, f"`{part.strip()}` holds no seed")
        if chosen[-1] > LARGEST:
            raise refused(text, f"`{part.strip()}` is too large: at most {LARGEST}")
        if chosen[MOST:]:
            raise refused(text, f"`{part.strip()}` is too many: at most {MOST} seeds")
        seeds.update(dict.fromkeys(chosen))
    return list(seeds)


def refused(text: str, what: str) -> Unusable:
    return Unusable(Mistake((), what, text, ALLOWED, "--seeds"))


def written(seeds: list[int]) -> str:
    """The shortest text for seeds: the inverse of `parse_seeds`."""
    parts: list[str] = []
    at = 0
    while at < len(seeds):
        end = at + 1
        while end < len(seeds) and seeds[end] == seeds[end - 1] + 1:
            end += 1
        parts.append(f"{seeds[at]}:{seeds[end - 1] + 1}" if end - at > 1 else str(seeds[at]))
        at = end
    return ",".join(parts)
