"""Which part of the schema a path in a file leads to, and the keys that it knows."""

from __future__ import annotations

from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel

from sim.worldfile.nodes import Path


def known_keys(model: type[BaseModel], data: Any, where: Path) -> list[str]:
    """The keys that may stand in the mapping at `where`, in the schema's order.

    `data` is the file as read: a body's `shape` decides which of its kinds is meant.
    """
    part: Any = model
    for key in where:
        data = _value_at(data, key)
        part = _below(part, key, data)
    return list(part.model_fields) if _is_part(part) else []


def _value_at(data: Any, key: str | int) -> Any:
    try:
        return data[key]
    except (KeyError, IndexError, TypeError):
        return None


def _below(part: Any, key: str | int, data: Any) -> Any:
    """The type of what stands at `key`; of a union's models the one that `data` names."""
    if _is_part(part):
        field = part.model_fields.get(key)
        inside = None if field is None else field.annotation
    else:  # tuple[X, ...] or dict[str, X]
        arguments = get_args(part)
        inside = None
        if arguments:
            inside = arguments[1] if get_origin(part) is dict else arguments[0]
    return _chosen(inside, data)


def _chosen(annotation: Any, data: Any) -> Any:
    while get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    if get_origin(annotation) not in (Union, UnionType):
        return annotation
    members = [_chosen(member, data) for member in get_args(annotation)]
    members = [member for member in members if member is not type(None)]
    shape = data.get("shape") if isinstance(data, dict) else None
    for member in members:
        field = member.model_fields.get("shape") if _is_part(member) else None
        if field is not None and get_args(field.annotation) == (shape,):
            return member
    return members[0] if members else None


def _is_part(part: Any) -> bool:
    return isinstance(part, type) and issubclass(part, BaseModel)
