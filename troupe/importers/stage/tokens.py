"""Stage's files cut into tokens, each with its place; included files are spliced in."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sim.worldfile.reading import NotRead, is_stream, read_regular, read_stream

LARGEST = 20_000_000
"""Bytes of a file."""

MOST_INCLUDES = 50
"""Files within files; more is a circle that a link hides."""

Kind = Literal["word", "number", "string", "(", ")", "[", "]", "end"]


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a file; line and column count from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class StageError(ValueError):
    """A file that Stage or Player could not use either, and where; `str()` says both."""

    def __init__(self, place: Place | None, what: str) -> None:
        self.place = place
        self.what = what
        super().__init__(f"{place}: {what}" if place is not None else what)


class Token(NamedTuple):
    """A word, number, string (without its quotes) or bracket."""

    kind: Kind
    text: str
    place: Place


_PATTERN = re.compile(
    r"""(?P<blank>[ \t\f\v]+|\#[^\r\n]*)
    |(?P<line>\r\n|\n|\r)
    |(?P<word>[A-Za-z_][A-Za-z0-9_.-]*(?:\[[0-9]+\](?:\.[A-Za-z_]\w*(?:\[[0-9]+\])?)?)?)
    |(?P<number>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?(?![\w.]))
    |"(?P<string>[^"\r\n]*)"
    |(?P<bracket>[()\[\]])""",
    re.VERBOSE,
)


def scan(text: str, file: str) -> Iterator[Token]:
    """The tokens of one file's text, without an `end`. Raises StageError."""
    line, begin, at = 1, 0, 0
    while at < len(text):
        match = _PATTERN.match(text, at)
        place = Place(file, line, at - begin + 1)
        if match is None:
            raise StageError(place, _unreadable(text, at))
        kind, value = match.lastgroup, match.group(match.lastgroup or 0)
        at = match.end()
        if kind == "line":
            line, begin = line + 1, at
        elif kind == "bracket":
            yield Token(value, value, place)  # type: ignore[arg-type]  # the pattern's brackets
        elif kind != "blank":
            yield Token(kind, value, place)  # type: ignore[arg-type]  # the pattern's groups


def _unreadable(text: str, at: int) -> str:
    if text[at] == '"':
        return 'a string without its closing " on the same line'
    if text[at] in "+-.0123456789":
        word = re.match(r"[-+.\w]+", text[at:])
        return f"not a number: {word.group() if word else text[at]}"
    return f"the character {text[at]!r} has no meaning here"


def read_tokens(path: str) -> list[Token]:
    """All tokens of a file and of what it includes, with an `end` after the last.

    An included file is looked for where Stage does: from the folder of the first file, then by
    its bare name in the folders of STAGEPATH; and besides from the including file's folder.
    Raises StageError, which names the place of the `include`.
    """
    tokens: list[Token] = []
    last = _read_into(tokens, path, os.path.dirname(path), (), None)
    tokens.append(Token("end", "", last))
    return tokens


def _read_into(
    tokens: list[Token], path: str, top: str, within: tuple[str, ...], asked: Place | None
) -> Place:
    """Append a file's tokens; the place of its end."""
    real = os.path.realpath(path)
    if real in within or len(within) > MOST_INCLUDES:
        raise StageError(asked, f"{path} includes itself")
    try:
        data = (read_stream if asked is None and is_stream(path) else read_regular)(path, LARGEST)
    except NotRead as error:
        raise StageError(asked or Place(path, 1, 1), f"{path} {error}") from None
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    place = Place(path, 1, 1)
    found = scan(text, path)
    for token in found:
        place = token.place
        if token.kind != "word" or token.text != "include":
            tokens.append(token)
            continue
        name = next(found, None)
        if name is None or name.kind != "string":
            raise StageError(token.place, 'after include a file name in quotes must stand: "..."')
        inner = _find(name, top, os.path.dirname(path))
        _read_into(tokens, inner, top, (*within, real), name.place)
    return place


def _find(name: Token, top: str, beside: str) -> str:
    """The file that an include names."""
    if not name.text:
        raise StageError(name.place, "include of a file without a name")
    text = os.path.expanduser(name.text)
    tries = [os.path.join(top, text), os.path.join(beside, text)]
    folders = os.environ.get("STAGEPATH", "").split(os.pathsep)
    tries += [os.path.join(folder, os.path.basename(text)) for folder in folders if folder]
    for path in tries:
        if os.path.isfile(path):
            return path
    looked = top or "."
    raise StageError(
        name.place,
        f"there is no file {name.text} to include (looked in {looked}; the environment variable "
        "STAGEPATH may name more folders)",
    )
