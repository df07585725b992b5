"""`troupe sensors`: Troupe's sensors, and with files those of a user's own."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner, Result

from sensors.readings import KINDS
from tests.troupe.own_sensor import example
from troupe.commands.sensors import READ_BY, sensors

app = typer.Typer()
app.command()(sensors)


def run(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def test_without_files_troupes_own_are_listed() -> None:
    shown = run().stdout
    for name in ("sensor laser", "sensor ranger", "sensor bumper", "actuator sprayer"):
        assert name in shown
    assert "min_range" in shown


def test_a_file_is_listed_with_its_settings_their_units_and_how_it_is_read(tmp_path: Path) -> None:
    nose = tmp_path / "nose.py"
    nose.write_text(example("nose.py"))
    done = run(str(nose))
    assert done.exit_code == 0, done.stderr
    flat = " ".join(done.stdout.split())
    assert "sensor nose: How strongly it smells of one colour." in flat
    assert "AioProxy" in flat
    assert "color (required) colour the colour of what smells" in flat
    assert "reach 5 m where a smell has faded to 37 %" in flat
    assert "sensor laser" not in flat


@pytest.mark.parametrize(
    ("text", "complaint"),
    [(None, "No such file"), ("1 / 0", "ZeroDivisionError"), ("x = 1", "registers none")],
)
def test_a_file_that_is_no_sensor_is_named_with_what_is_wrong(
    tmp_path: Path, text: str | None, complaint: str
) -> None:
    file = tmp_path / "mine.py"
    if text is not None:
        file.write_text(text)
    done = run(str(file))
    assert done.exit_code == 2
    assert str(file) in done.stderr
    assert complaint in done.stderr


def test_every_kind_of_readings_has_a_proxy_to_read_it_with() -> None:
    assert set(READ_BY) == set(KINDS)
