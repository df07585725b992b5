"""The schema's errors in a reader's words."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from sim.worldfile.fields import known_keys
from sim.worldfile.mistakes import MOST_TOLD, Mistake, listed, suggestion
from sim.worldfile.nodes import Path

_TRUTHS_OF_YAML_1_1 = {"yes", "no", "on", "off", "y", "n"}
_SEXAGESIMAL = re.compile(r"[-+]?[0-9]+(:[0-9]+)+(\.[0-9]*)?")
_WITH_UNIT = re.compile(r"[-+]?[0-9.]+ *[^0-9. ]+")

_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "float_parsing": "a number",
    "int_parsing": "a whole number",
}


def shown(value: Any) -> str:
    """A value as a reader would write it, cut to one short line."""
    text = _written(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _written(value: Any, depth: int = 0) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else (".inf" if value > 0 else "-.inf")
    if isinstance(value, str):
        plain_text = value and value == value.strip() and value.isprintable()
        return value if plain_text and depth == 0 else repr(value)
    if isinstance(value, Mapping):
        if depth > 1:
            return "{...}"
        inside = [f"{key}: {_written(item, depth + 1)}" for key, item in list(value.items())[:4]]
        return "{" + ", ".join(inside + ["..."] * (len(value) > 4)) + "}"
    if isinstance(value, Sequence):
        if depth > 1:
            return "[...]"
        inside = [_written(item, depth + 1) for item in value[:6]]
        return "[" + ", ".join(inside + ["..."] * (len(value) > 6)) + "]"
    return str(value)


def mistakes_in(
    error: ValidationError, data: Any, model: type[BaseModel]
) -> list[tuple[Mistake, list[Path]]]:
    """Every error of a validation of `data` by `model` as a mistake at its place in `data`.

    Beside each stand the places of other values that it rests on.
    """
    keys: dict[Path, list[str]] = {}
    unknown = 0
    found: list[tuple[Mistake, list[Path]]] = []
    for one in error.errors(include_url=False):
        if one["type"] != "extra_forbidden":
            found.append((_mistake(one, data), _rests_on(one, data)))
            continue
        where = place_in(data, one["loc"])
        unknown += 1
        if where[:-1] not in keys:
            keys[where[:-1]] = known_keys(model, data, where[:-1])
        known = keys[where[:-1]]
        # To look for what was meant takes a while: as often as anybody would read it.
        hint = suggestion(str(where[-1]), known) if unknown <= MOST_TOLD else ""
        found.append(
            (Mistake(where, f"unknown key{hint}", None, listed(known, 20), at_key=True), [])
        )
    return found


def _rests_on(error: ErrorDetails, data: Any) -> list[Path]:
    if error["type"] != "world":
        return []
    where = place_in(data, error["loc"])
    return [(*where, key) for key in error.get("ctx", {}).get("uses", ())]


def place_in(data: Any, loc: Path) -> Path:
    """An error's location as a path in the file: without the names of a union's members."""
    path: list[str | int] = []
    here, tagged = data, False
    for index, key in enumerate(loc):
        last = index == len(loc) - 1
        if key == "[key]" and last:
            break
        if isinstance(here, Mapping) and isinstance(key, str):
            if not last and not tagged and key in (here.get("shape"), here.get("type")):
                tagged = True
                continue
            path.append(key)
            here, tagged = here.get(key), False
        elif isinstance(here, Sequence) and not isinstance(here, str) and isinstance(key, int):
            path.append(key)
            here, tagged = here[key] if key < len(here) else None, False
    return tuple(path)


def _mistake(error: ErrorDetails, data: Any) -> Mistake:
    where = place_in(data, error["loc"])
    context = error.get("ctx", {})
    value = error["input"]
    kind = error["type"]
    match kind:
        case "world":
            given = context.get("given")
            return Mistake(
                (*where, *context.get("at", ())),
                context["what"],
                None if given is None else shown(given),
                context.get("allowed"),
                at_key=context.get("at_key", False) or error["loc"][-1:] == ("[key]",),
            )
        case "missing":
            if isinstance(where[-1], int):
                return Mistake(where[:-1], "has too few values", None, f"more than {where[-1]}")
            return Mistake(where, "is missing", None, None)
        case "too_long":
            most = context.get("max_length")
            return Mistake(where, "has too many values", shown(value), f"at most {most}")
        case "union_tag_not_found":
            key = context["discriminator"].strip("'")
            allowed = {"shape": "box, circle, polygon", "type": "sprayer, gripper"}[key]
            return Mistake((*where, key), "is missing", None, allowed)
        case "union_tag_invalid":
            expected = context["expected_tags"].replace("'", "")
            key = context["discriminator"].strip("'")
            return _choice((*where, key), context["tag"], expected.split(", "))
        case "literal_error":
            expected = context["expected"].replace(" or ", ", ").replace("'", "")
            return _choice(where, value, expected.split(", "))
        case "greater_than":
            return _limit(where, value, f"above {context['gt']:g}")
        case "greater_than_equal":
            return _limit(where, value, f"{context['ge']:g} or more")
        case "less_than":
            return _limit(where, value, f"below {context['lt']:g}")
        case "less_than_equal":
            return _limit(where, value, f"{context['le']:g} or less")
        case "finite_number":
            return Mistake(where, "must be a finite number", shown(value))
        case "too_short" | "string_too_short":
            return Mistake(where, "must not be empty", shown(value))
        case "value_error":
            return Mistake(where, str(context.get("error", error["msg"])), shown(value))
    if kind in _TYPES:
        return Mistake(where, f"must be {_TYPES[kind]}{_hint(kind, value)}", shown(value))
    return Mistake(where, error["msg"][:1].lower() + error["msg"][1:], shown(value))


def _limit(where: Path, value: Any, allowed: str) -> Mistake:
    return Mistake(where, "is out of range", shown(value), allowed)


def _choice(where: Path, value: Any, allowed: list[str]) -> Mistake:
    hint = suggestion(value, allowed) if isinstance(value, str) else ""
    return Mistake(where, f"unknown choice{hint}", shown(value), ", ".join(allowed))


def _hint(kind: str, value: Any) -> str:
    """What a user of YAML 1.1, or of units, may have had in mind."""
    if not isinstance(value, str):
        return ""
    if kind == "bool_type" and value.casefold() in _TRUTHS_OF_YAML_1_1:
        return f"; {value} is text in YAML 1.2"
    if kind in ("float_type", "int_type"):
        if _SEXAGESIMAL.fullmatch(value):
            return "; 1:30 is text in YAML 1.2"
        if _WITH_UNIT.fullmatch(value):
            return " without a unit"
    return ""
