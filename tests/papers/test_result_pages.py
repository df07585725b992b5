"""The pages of results are their templates, filled from the tables that lie beside them."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.processes import ROOT, environment

RENDER = """\
import sys
sys.path[:0] = [{root!r}, {scripts!r}]
import pages
for name in pages.names():
    print("====", name)
    sys.stdout.write(pages.render(name))
"""


@pytest.fixture(scope="module")
def rendered() -> dict[str, str]:
    code = RENDER.format(root=str(ROOT), scripts=str(ROOT / "scripts"))
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    parts = [part.partition("\n") for part in done.stdout.split("==== ")[1:]]
    return {name: text for name, _, text in parts}


def test_every_page_of_results_has_a_template(rendered: dict[str, str]) -> None:
    pages = (ROOT / "docs" / "results").glob("*.md")
    assert sorted(rendered) == sorted(page.stem for page in pages)


@pytest.mark.parametrize("name", ["fcdfs", "fcdfs_bodies", "paint"])
def test_a_page_is_what_its_template_makes_of_its_tables(
    rendered: dict[str, str], name: str
) -> None:
    assert rendered[name] == (ROOT / "docs" / "results" / f"{name}.md").read_text()
