"""`troupe schema`: JSON Schema of world files, for editors."""

from __future__ import annotations

import json


def schema() -> None:
    """Print the JSON Schema (draft 2020-12) of world files, for editors.

    With the YAML extension of an editor: `# yaml-language-server: $schema=FILE` as first line.
    """
    from sim.worldfile.json_schema import json_schema  # noqa: PLC0415 - `--help` stays quick

    print(json.dumps(json_schema(), indent=2))
