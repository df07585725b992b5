"""The schema of world files as JSON Schema (draft 2020-12), for editors and other tools."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from sim.worldfile.schema import World

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema() -> dict[str, Any]:
    """JSON Schema of a world file as it is written: degrees, colours as text, `include`.

    It describes single files; a file that others include may leave out what they require.
    """
    schema = World.model_json_schema(ref_template="#/$defs/{model}", mode="validation")
    definitions: dict[str, Any] = schema["$defs"]
    name_file = {"type": "string", "minLength": 1}
    include = {
        "anyOf": [name_file, {"type": "array", "items": name_file}],
        "description": "files that are read first, relative to this one; mappings merge, lists and "
        "scalars are replaced",
    }
    schema["properties"] = {"include": include, **schema["properties"]}
    definitions["Model"]["properties"]["sensors"]["items"] = _sensors(definitions)
    placement = definitions["Robots"]["properties"]["placement"]
    placement["anyOf"].insert(0, {"const": "random"})
    definitions["Controller"]["properties"]["args"] = _args(definitions["Controller"])
    _required_alternatives(schema, definitions)
    return {"$schema": DIALECT, **_written(schema), "title": "A world file of Troupe"}


def _sensors(definitions: dict[str, Any]) -> dict[str, Any]:
    """Every registered sensor, told apart by its `type`; or a sensor file of the user's own."""
    from sensors.registry import SENSORS  # noqa: PLC0415

    refs: list[dict[str, Any]] = []
    for name, sensor in SENSORS.items():
        one = sensor.settings.model_json_schema(
            ref_template="#/$defs/{model}", mode="validation", schema_generator=GenerateJsonSchema
        )
        definitions.update(one.pop("$defs", {}))
        one.pop("title", None)
        kind = {"const": name, "description": sensor.summary}
        one["properties"] = {"type": kind, **one["properties"]}
        one["required"] = ["type", *one.get("required", [])]
        one["description"] = sensor.summary
        definitions[f"sensor_{name}"] = one
        refs.append({"$ref": f"#/$defs/sensor_{name}"})
    definitions["sensor_file"] = {
        "type": "object",
        "description": "a sensor file of your own, with its settings",
        "properties": {"type": {"type": "string", "pattern": r"\.py$"}},
        "required": ["type"],
    }
    return {"oneOf": [*refs, {"$ref": "#/$defs/sensor_file"}]}


def _args(controller: dict[str, Any]) -> dict[str, Any]:
    one: dict[str, Any] = {"type": ["string", "number", "boolean", "null"]}
    several = {"type": "array", "items": {"type": ["string", "number"]}}
    return {
        "type": "object",
        "propertyNames": {"pattern": "^[A-Za-z][A-Za-z0-9_-]*$"},
        "additionalProperties": {"anyOf": [one, several]},
        "description": controller["properties"]["args"]["description"],
    }


def _required_alternatives(schema: dict[str, Any], definitions: dict[str, Any]) -> None:
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
