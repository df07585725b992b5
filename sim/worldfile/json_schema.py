"""The schema of world files as JSON Schema (draft 2020-12), for editors and other tools."""

from __future__ import annotations

import copy
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from sim.worldfile.schema import World
from sim.worldfile.values import NAME

REF = "#/$defs/"
FRAGMENT = "_fragment"
DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """JSON Schema of a world file as it is written: degrees, colours as text, `include`.

    A file that includes others may leave out what stands in them, down to a model's body, so it
    is described by `Fragment` and all others by `World`. Whether a file *without* `include` is
    meant for others to include cannot be told: it is described as a world, of which only `size`
    or `map` are not asked for.
    """
    world = World.model_json_schema(ref_template=REF + "{model}", mode="validation")
    definitions: dict[str, Any] = world.pop("$defs")
    world["properties"] = {"include": _include(), **world["properties"]}
    models = world["properties"]["models"]
    models.pop("patternProperties", None)  # by them alone other names would be allowed
    models |= {"propertyNames": {"pattern": NAME}, "additionalProperties": {"$ref": REF + "Model"}}
    definitions["Model"]["properties"]["sensors"]["items"] = _sensors(definitions)
    definitions["Robots"]["properties"]["placement"]["anyOf"].insert(0, {"const": "random"})
    definitions["Controller"]["properties"]["args"] = _args(definitions["Controller"])
    definitions["World"] = world
    _add_fragments(definitions)
    _add_alternatives(definitions)
    return {
        "$schema": DIALECT,
        "title": "A world file of Troupe",
        "type": "object",
        "if": {"required": ["include"]},
        "then": {"$ref": REF + "Fragment"},
        "else": {"$ref": REF + "World"},
        "$defs": _written(definitions),
    }


def _include() -> dict[str, Any]:
    name = {"type": "string", "minLength": 1}
    return {
        "anyOf": [name, {"type": "array", "items": name}],
        "description": "files that are read first, relative to this one; mappings merge, lists and "
        "scalars are replaced",
    }


def _add_fragments(definitions: dict[str, Any]) -> None:
    """Adds the parts that may be spread over files: what they require may stand elsewhere."""
    spread = ("Model", "Drive", "Map", "Controller")
    for name in spread:
        part = copy.deepcopy(definitions[name])
        part.pop("required", None)
        definitions[name + FRAGMENT] = part
    body: dict[str, Any] = {}
    for name in ("Compound", "Polygon", "Circle", "Box"):
        body |= definitions[name]["properties"]
    shape = {
        "enum": ["box", "circle", "polygon", "compound"],
        "description": body["shape"]["description"],
    }
    definitions["Body" + FRAGMENT] = {
        "type": "object",
        "properties": {**body, "shape": shape},
        "additionalProperties": False,
    }
    model = definitions["Model" + FRAGMENT]["properties"]
    description = model["body"].get("description")
    model["body"] = {"$ref": REF + "Body" + FRAGMENT, "description": description}
    world = copy.deepcopy(definitions["World"])
    for part in (world, definitions["Model" + FRAGMENT]):
        for name in spread:
            _point(part["properties"], REF + name, REF + name + FRAGMENT)
    definitions["Fragment"] = world


def _point(node: Any, old: str, new: str) -> None:
    """Makes references to `old` lead to `new`."""
    if isinstance(node, dict):
        if node.get("$ref") == old:
            node["$ref"] = new
        for inside in node.values():
            _point(inside, old, new)
    elif isinstance(node, list):
        for inside in node:
            _point(inside, old, new)


def _sensors(definitions: dict[str, Any]) -> dict[str, Any]:
    """Every registered sensor, told apart by its `type`; or a sensor file of the user's own."""
    from sensors.registry import SENSORS  # noqa: PLC0415

    refs: list[dict[str, Any]] = []
    for name, sensor in SENSORS.items():
        one = sensor.settings.model_json_schema(
            ref_template=REF + "{model}", mode="validation", schema_generator=GenerateJsonSchema
        )
        definitions.update(one.pop("$defs", {}))
        one.pop("title", None)
        kind = {"const": name, "description": sensor.summary}
        one["properties"] = {"type": kind, **one["properties"]}
        one["required"] = ["type", *one.get("required", [])]
        one["description"] = sensor.summary
        definitions[f"sensor_{name}"] = one
        refs.append({"$ref": f"{REF}sensor_{name}"})
    definitions["sensor_file"] = {
        "type": "object",
        "description": "a sensor file of your own, with its settings",
        "properties": {"type": {"type": "string", "pattern": r"\.py$"}},
        "required": ["type"],
    }
    return {"oneOf": [*refs, {"$ref": REF + "sensor_file"}]}


def _args(controller: dict[str, Any]) -> dict[str, Any]:
    one: dict[str, Any] = {"type": ["string", "number", "boolean", "null"]}
    several = {"type": "array", "items": {"type": ["string", "number"]}}
    return {
        "type": "object",
        "propertyNames": {"pattern": "^[A-Za-z][A-Za-z0-9_-]*$"},
        "additionalProperties": {"anyOf": [one, several]},
        "description": controller["properties"]["args"]["description"],
    }


def _add_alternatives(definitions: dict[str, Any]) -> None:
    """What the schema's validators ask for and JSON Schema can say."""
    definitions["Robots"]["oneOf"] = [
        {"required": ["pose"], "properties": {"pose": {"type": "array"}, "count": {"const": 1}}},
        {"required": ["placement"], "properties": {"placement": {"type": ["string", "object"]}}},
    ]
    definitions["Controller"]["oneOf"] = [
        {"required": ["program"], "properties": {"program": {"type": "string"}}},
        {"required": ["command"], "properties": {"command": {"type": "array"}}},
        {"required": ["external"], "properties": {"external": {"const": True}}},
    ]
    definitions["Map"]["oneOf"] = [
        {"required": ["resolution"], "properties": {"resolution": {"type": "number"}}},
        {"required": ["cell"], "properties": {"cell": {"type": "number"}}},
    ]
    definitions["Drive"]["if"] = {"properties": {"kind": {"const": "car"}}, "required": ["kind"]}
    definitions["Drive"]["then"] = {"required": ["wheelbase", "max_steering"]}


def _written(node: Any) -> Any:
    """The schema with defaults as they are written: colours as text, no defaults of whole parts."""
    if isinstance(node, list):
        return [_written(item) for item in node]
    if not isinstance(node, dict):
        return node
    out = {key: _written(value) for key, value in node.items()}
    if isinstance(out.get("default"), dict):
        del out["default"]
    if out.get("format") == "color" and isinstance(out.get("default"), int):
        out["default"] = f"#{out['default']:06x}"
    if set(out) >= {"title", "type"} or set(out) >= {"title", "anyOf"}:
        del out["title"]  # pydantic's: the key again
    return out
