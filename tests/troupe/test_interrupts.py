"""Ctrl-C while modules are loaded: Python may swallow the exception there, the command ends."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.processes import environment

LOADED = """
import os, signal, weakref
class Thing: pass
thing = Thing()
gone = weakref.ref(thing, lambda _: os.kill(os.getpid(), signal.SIGINT))
del thing
"""
LOADING = """
from troupe.interrupts import heed_interrupts
{heed}
import loaded
print("still here")
"""


@pytest.mark.parametrize("heeds", [True, False])
def test_an_interrupt_in_a_callback_of_the_import_machinery_ends_the_command(
    tmp_path: Path, heeds: bool
) -> None:
    (tmp_path / "loaded.py").write_text(LOADED)
    program = LOADING.format(heed="heed_interrupts()" if heeds else "")
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, env=environment(),
        capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip
    if heeds:
        assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
    else:  # what Python does by itself
        assert "still here" in done.stdout


def test_an_interrupt_elsewhere_is_an_exception() -> None:
    program = (
        "import os, signal\n"
        "from troupe.interrupts import heed_interrupts\n"
        "heed_interrupts()\n"
        "try:\n    os.kill(os.getpid(), signal.SIGINT)\n"
        "except KeyboardInterrupt:\n    print('caught')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment(), capture_output=True, text=True,
        check=True, timeout=PATIENCE,
    )  # fmt: skip
    assert done.stdout == "caught\n"
