"""The example of docs/sensors.md: a sensor of one's own, a world with it, and who reads it."""

from __future__ import annotations

import re

from tests.processes import ROOT


def example(name: str) -> str:
    """The code of that name on the page."""
    page = (ROOT / "docs" / "sensors.md").read_text(encoding="utf-8")
    pattern = rf"<!-- example: {re.escape(name)} -->\n```\w+\n(.*?)```"
    found = re.search(pattern, page, re.DOTALL)
    assert found, name
    return found[1]
