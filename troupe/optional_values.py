"""Options that take a value or none: `--view`, `--view 7000`, `--realtime`, `--realtime 2`.

The word behind such an option is its value, unless the command would then lack an argument that it
must have: `troupe run --view wander` has the world `wander`, and `troupe run wander --view nowhere`
an address that is none.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, cast

import typer
from typer.core import TyperCommand

MISUSED = cast("type[Exception]", typer.BadParameter.__bases__[0])
"""What Click raises for words that a command does not know."""


class Optional(NamedTuple):
    """What an option has by itself, and what its values look like."""

    alone: str
    values: re.Pattern[str]


OPTIONAL = {
    "--view": Optional("", re.compile(r"\[?[\w.:-]*\]?:\d+|\d+")),
    "--realtime": Optional("1", re.compile(r"[+-]?[\d.]+(e[+-]?\d+)?", re.IGNORECASE)),
    "--log-sensors": Optional("all", re.compile(r"all|\w+(,\w+)+")),
}
"""All of them, by name. What its values look like only decides between two words for one world."""


class Command(TyperCommand):
    """A command whose options of OPTIONAL may stand without a value."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Click's own, with a value at each of its options."""
        names = [name for one in self.params for name in one.opts]
        mine = {name: OPTIONAL[name] for name in names if name in OPTIONAL}
        words, taken = with_values(args, mine)
        if taken and self._lacks(ctx, words):
            least = max(taken, key=lambda at: not _fits(words[at]))
            option, _, word = words[least].partition("=")
            words[least : least + 1] = [f"{option}={mine[option].alone}", word]
        return super().parse_args(ctx, words)

    def _lacks(self, ctx: Any, words: list[str]) -> bool:
        """Whether an argument is missing, such as the world."""
        try:
            found, _, _ = self.make_parser(ctx).parse_args(list(words))
        except MISUSED:
            return False  # said when it is parsed
        needed = [one for one in self.params if one.param_type_name == "argument" and one.required]
        return any(not _is_there(found.get(one.name)) for one in needed)


def with_values(
    args: Sequence[str], options: Mapping[str, Optional]
) -> tuple[list[str], list[int]]:
    """The words with a value at each of the options, and where this was the word behind it."""
    words: list[str] = []
    taken: list[int] = []
    left = list(args)
    while left:
        word = left.pop(0)
        if word == "--":
            return [*words, word, *left], taken
        if word in options:
            follows = left and (not left[0].startswith("-") or _looks(word, left[0]))
            if follows:
                taken.append(len(words))
            word = f"{word}={left.pop(0) if follows else options[word].alone}"
        words.append(word)
    return words, taken


def _fits(word: str) -> bool:
    """Whether the value of `--option=value` looks like one."""
    option, _, value = word.partition("=")
    return _looks(option, value)


def _looks(option: str, value: str) -> bool:
    return OPTIONAL[option].values.fullmatch(value) is not None


def _is_there(value: Any) -> bool:
    """Whether Click's parser has found words for an argument: else it has a mark of its own."""
    return isinstance(value, str | tuple | list) and bool(value)
