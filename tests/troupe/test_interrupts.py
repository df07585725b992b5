"""Signals while modules are loaded: Python may swallow an exception there, the command ends."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.processes import ROOT, environment

TROUPE = Path(sys.executable).with_name("troupe")
"""The command as it is installed."""

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


def test_an_interrupt_is_an_exception_where_a_command_asks_for_it() -> None:
    program = (
        "import os, signal\n"
        "from troupe.interrupts import heed_interrupts, leave, raised\n"
        "heed_interrupts()\n"
        "try:\n    with raised():\n        os.kill(os.getpid(), signal.SIGTERM)\n"
        "except KeyboardInterrupt:\n    print('caught')\n"
        "assert signal.getsignal(signal.SIGTERM) is leave\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment(), capture_output=True, text=True,
        check=True, timeout=PATIENCE,
    )  # fmt: skip
    assert done.stdout == "caught\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("words", [["-m", "troupe"], [str(TROUPE)]])
def test_signals_are_heeded_before_our_own_packages_are_loaded(
    tmp_path: Path, words: list[str], number: int
) -> None:
    """`player` loads numpy, which takes a moment."""
    (tmp_path / "numpy.py").write_text(f"import os\nos.kill(os.getpid(), {int(number)})\n")
    done = subprocess.run(
        [sys.executable, *words, "schema"],
        env={**environment(), "PYTHONPATH": f"{tmp_path}:{ROOT}"},
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_a_program_that_imports_troupe_keeps_its_handlers() -> None:
    program = (
        "import signal, troupe\n"
        "assert signal.getsignal(signal.SIGINT) is signal.default_int_handler\n"
        "assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL\n"
    )
    subprocess.run([sys.executable, "-c", program], env=environment(), check=True, timeout=600)
