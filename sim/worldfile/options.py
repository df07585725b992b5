"""A controller's `args` to options on its command line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from sim.worldfile.values import wrong

_KEY = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


def options(args: Mapping[str, Any]) -> list[str]:
    """The command-line options that `args` stand for, in their order.

    `robots: 4` is `--robots 4`, `max_speed: -1` is `--max-speed=-1` (a value that begins with
    a dash would else be taken for an option), `paint: true` is `--paint`, `paint: false` is
    `--no-paint`, a list repeats its option, and null leaves it out.
    """
    words: list[str] = []
    for key, value in args.items():
        option = "--" + key.replace("_", "-")
        for item in value if isinstance(value, tuple | list) else (value,):
            if item is None:
                continue
            if isinstance(item, bool):
                words.append(option if item else "--no-" + option[2:])
                continue
            text = str(item)
            words += [f"{option}={text}"] if text.startswith("-") else [option, text]
    return words


def checked_args(value: Any) -> dict[str, Any]:
    """The schema's check of `args`: keys that can be options, values that options can have."""
    if not isinstance(value, dict):
        raise wrong("must be a mapping", given=value, allowed="{option: value, ...}")
    for key, item in value.items():
        if not isinstance(key, str) or not _KEY.fullmatch(key):
            raise wrong(
                "cannot be an option",
                given=key,
                allowed="a letter, then letters, digits, _ and -",
                at=(key,),
                at_key=True,
            )
        if isinstance(item, dict):
            raise wrong(
                "an option has no mapping as its value",
                given=item,
                allowed="text, a number, true, false, or a list of texts and numbers",
                at=(key,),
            )
        if isinstance(item, tuple | list):
            for index, one in enumerate(item):
                if isinstance(one, bool) or not isinstance(one, str | int | float):
                    raise wrong(
                        "a list repeats its option with each value",
                        given=one,
                        allowed="texts and numbers",
                        at=(key, index),
                    )
    return dict(value)
