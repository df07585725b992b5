"""The syntax of Stage's files: properties, nested entities, and macros with inheritance."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from sim.worldfile.mistakes import listed, suggestion
from troupe.importers.stage.tokens import Place, StageError, Token, read_tokens

DEEPEST = 60
"""Entities within entities, and macros upon macros."""

MOST_ENTITIES = 100_000
"""Entities of one file, macros expanded: short files can ask for more than memory holds."""


@dataclass(frozen=True, slots=True)
class Property:
    """A name and its value: one number or string, or those of a tuple."""

    name: str
    values: tuple[float | str, ...]
    place: Place


@dataclass(frozen=True, slots=True)
class _Call:
    """`word ( ... )` as it was written."""

    word: str
    body: tuple[Property | _Call, ...]
    place: Place


@dataclass
class Entity:
    """An entity with all that its macros give it.

    `type` is the type at the root of its macros, `word` what was written where it stands, and
    `place` that place. `used` names the properties that somebody has read.
    """

    word: str
    type: str
    place: Place
    macros: tuple[str, ...] = ()
    properties: dict[str, Property] = field(default_factory=dict)
    children: list[Entity] = field(default_factory=list)
    used: set[str] = field(default_factory=set)


def read_file(path: str, types: Collection[str]) -> Entity:
    """The file's properties and entities, as an entity of type "world".

    `types` are the types that there are. Raises StageError.
    """
    return _Reader(read_tokens(path), types, path).read()


class _Reader:
    """Goes through the tokens once; macros hold from where they are defined."""

    def __init__(self, tokens: list[Token], types: Collection[str], path: str) -> None:
        self.tokens = tokens
        self.types = types
        self.at = 0
        self.macros: dict[str, _Call] = {}
        self.count = 0
        self.root = Entity("world", "world", Place(path, 1, 1))

    def read(self) -> Entity:
        while self.tokens[self.at].kind != "end":
            token = self.take()
            if token.kind == "word" and token.text == "define":
                self.define()
                continue
            statement = self.statement(token, 0)
            if isinstance(statement, Property):
                self.root.properties[statement.name] = statement
            else:
                self.root.children.append(self.create(statement, 0))
        return self.root

    def take(self) -> Token:
        token = self.tokens[self.at]
        self.at += 1
        return token

    def define(self) -> None:
        """`define name base ( ... )`, from the name on."""
        name, base = self.take(), self.take()
        for token, what in ((name, "a new type's name"), (base, "the type that it builds on")):
            if token.kind != "word":
                raise StageError(token.place, f"after define {what} must stand, {_found(token)}")
        opening = self.take()
        if opening.kind != "(":
            raise StageError(
                opening.place, f"define {name.text} {base.text} needs ( ... ), {_found(opening)}"
            )
        body = self.body(opening, 0)
        self.macros[name.text] = _Call(base.text, body, name.place)

    def statement(self, token: Token, depth: int) -> Property | _Call:
        """A property or an entity that begins with `token`."""
        if token.kind != "word":
            raise StageError(
                token.place, f"a property or an entity must begin here, {_found(token)}"
            )
        if token.text == "define":
            raise StageError(token.place, "define cannot stand within an entity")
        following = self.take()
        if following.kind == "(":
            if depth > DEEPEST:
                raise StageError(token.place, f"more than {DEEPEST} entities within each other")
            return _Call(token.text, self.body(following, depth + 1), token.place)
        if following.kind in ("number", "string"):
            return Property(token.text, (_value(following),), token.place)
        if following.kind == "[":
            return Property(token.text, self.tuple(following), token.place)
        raise StageError(
            following.place, f"after {token.text} a value or ( must stand, {_found(following)}"
        )

    def body(self, opening: Token, depth: int) -> tuple[Property | _Call, ...]:
        """The statements up to the closing parenthesis."""
        found: list[Property | _Call] = []
        while True:
            token = self.take()
            if token.kind == ")":
                return tuple(found)
            if token.kind == "end":
                raise StageError(opening.place, "this ( is never closed")
            found.append(self.statement(token, depth))

    def tuple(self, opening: Token) -> tuple[float | str, ...]:
        """The values up to the closing bracket."""
        found: list[float | str] = []
        while True:
            token = self.take()
            if token.kind == "]":
                return tuple(found)
            if token.kind == "end":
                raise StageError(opening.place, "this [ is never closed")
            if token.kind not in ("number", "string"):
                raise StageError(
                    token.place,
                    f"a list holds numbers and strings, divided by blanks, {_found(token)}",
                )
            found.append(_value(token))

    def create(self, call: _Call, depth: int) -> Entity:
        """The entity that a call makes, its macros expanded."""
        self.count += 1
        if self.count > MOST_ENTITIES:
            raise StageError(call.place, f"the file asks for more than {MOST_ENTITIES} entities")
        if depth > DEEPEST:
            raise StageError(
                call.place, f"{call.word} is defined by itself, or lies more than {DEEPEST} deep"
            )
        macro = self.macros.get(call.word)
        if macro is not None:
            entity = self.create(macro, depth + 1)
            entity.macros = (call.word, *entity.macros)
        elif call.word in self.types:
            entity = Entity(call.word, call.word, call.place)
        else:
            known = [*self.macros, *sorted(self.types)]
            raise StageError(
                call.place,
                f"there is no type {call.word}{suggestion(call.word, known)} (there are "
                f"{listed(known, 30)}; a file that defines it may have to be included first)",
            )
        entity.word, entity.place = call.word, call.place
        for statement in call.body:
            if isinstance(statement, Property):
                entity.properties[statement.name] = statement
            else:
                entity.children.append(self.create(statement, depth + 1))
        return entity


def _value(token: Token) -> float | str:
    return float(token.text) if token.kind == "number" else token.text


def _found(token: Token) -> str:
    """What stands there instead, for a message."""
    if token.kind == "end":
        return "but the file ends"
    text = f'"{token.text}"' if token.kind == "string" else token.text
    return f"not {text}"
