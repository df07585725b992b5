"""The kernels are compiled once, all of them, and what is damaged of their cache does no harm."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests import started
from tests.processes import environment, troupe_command
from troupe.kernel_cache import is_whole, sealed
from troupe.warm import KEPT, NOT_KEPT

EVERYTHING = """
from pathlib import Path
from tempfile import TemporaryDirectory
import troupe
from troupe.compiling import Compiling
from troupe.warm import warm_once
from troupe.worlds import world_names

lines = []
with Compiling(lambda line: None) as compiling:
    warm_once(lines.append)
assert not compiling.spans  # all that is compiled for the first command had been kept
assert len(lines) == 1 and lines[0].startswith("compiling the kernels"), lines
warm_once(lines.append)
assert len(lines) == 1, lines
troupe.run("wander", duration=0.3, say=lines.append)
assert len(lines) == 1, lines
with Compiling() as compiling, TemporaryDirectory() as folder:
    for name in world_names():
        log = Path(folder, f"{name}.mcap")
        with troupe.Simulation(name, controllers=False, log=log, log_sensors=["all"]) as simulation:
            simulation.step(3)
    with troupe.Simulation("wander", controllers=False) as simulation:
        for _ in range(400):
            simulation.command(simulation.names, forward=0.5)
            simulation.step()
        assert simulation.contacts.any()
    from gridworld.grid import simulate
    from gridworld.median import best_door
    from gridworld.regions import load, rectangle
    from controllers.dispersal.rules import RULES
    from troupe.maps import map_files
    for path in map_files().values():
        region = load(path)
        region = region if region.doors else region.with_doors([best_door(region)])
        for rule in RULES:
            simulate(region, rule, q=0.1, seed=3)
    assert not compiling.spans
print("nothing else was compiled")
"""


WARMED = """
import os, shutil, sys
from numba.core import caching
from troupe.kernel_cache import distrust_cache
from troupe.warm import compile_all

distrust_cache()
file = caching.IndexDataCacheFile
load, save = file.load, file.save
used = set()


def use(self, key):
    used.update((self._index_path, self._data_path(self._load_index()[key])))


def loaded(self, key):
    data = load(self, key)
    if data is not None:
        use(self, key)
    return data


def saved(self, key, data):
    save(self, key, data)
    use(self, key)


file.load, file.save = loaded, saved
compile_all()
for path in used:
    package = os.path.dirname(os.path.dirname(path))
    place = caching._CacheLocator.get_suitable_cache_subpath(os.path.join(package, "any.py"))
    os.makedirs(os.path.join(sys.argv[1], place), exist_ok=True)
    shutil.copy2(path, os.path.join(sys.argv[1], place))
print(len(used))
"""
"""Copies to another folder the machine code of the kernels that are compiled for the first command,
and of no others: what it would have if all had been compiled there, which takes a minute."""


def python(program: str, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program, *words], env=environment(**variables),
        capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip


def troupe(cache: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        troupe_command(*words), env=environment(NUMBA_CACHE_DIR=str(cache)),
        capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip


def test_the_first_command_compiles_everything_and_later_ones_mend_what_is_damaged(
    tmp_path: Path,
) -> None:
    """In a cache of its own."""
    done = python(WARMED, str(tmp_path))
    assert int(done.stdout) > 50, done.stderr
    done = python(EVERYTHING, NUMBA_CACHE_DIR=str(tmp_path))
    assert done.stdout == "nothing else was compiled\n", done.stderr
    for words in (
        ("run", "wander", "--duration", "0.3"),
        ("disperse", "--grid", "4x4", "--door", "best"),
        ("check", "wander"),
    ):
        later = troupe(tmp_path, *words)
        assert (later.returncode, later.stderr) == (0, ""), words

    (kept,) = tmp_path.glob("sensors_*")
    warm = troupe(tmp_path, "warm")
    assert (warm.returncode, warm.stderr) == (0, "")
    assert warm.stdout == f"all kernels are compiled, and kept in {kept}\n"
    for mark in kept.glob("*.warm"):
        mark.unlink()
    assert troupe(tmp_path, "warm").stderr == KEPT.format(kept) + "\n"

    (folder,) = tmp_path.glob("gridworld_*")
    for number, path in enumerate(sorted(folder.glob("*.nb?"))):
        path.write_bytes(path.read_bytes()[: (number % 3) * 40])
    again = ["compiling a kernel that is new here (only once; it may take a minute) ..."]
    for lines in (again, []):
        later = troupe(tmp_path, "disperse", "--grid", "4x4", "--door", "best")
        assert (later.returncode, later.stderr.splitlines()) == (0, lines)


KERNEL = """
import numba
from troupe.kernel_cache import distrust_cache
distrust_cache()
@numba.njit(numba.int64(numba.int64), cache=True)
def double(x):
    return 2 * x
print(double(21), sum(double.stats.cache_hits.values()))
"""


def cut(data: bytes) -> bytes:
    return data[: len(data) // 2]


def flipped(data: bytes) -> bytes:
    """One bit, within what is code."""
    middle = data.find(b"\x7fELF") + 700 if b"\x7fELF" in data else len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 16]) + data[middle + 1 :]


def run_kernel(folder: Path) -> str:
    done = started.troupe(program=folder / "kernel.py")
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a kernel whose machine code has been kept."""
    folder = tmp_path_factory.mktemp("kept")
    (folder / "kernel.py").write_text(KERNEL)
    assert [run_kernel(folder), run_kernel(folder)] == ["42 0\n", "42 1\n"]
    return folder


@pytest.mark.parametrize("damage", [lambda data: b"", cut, flipped, lambda data: b"\x80garbage"])
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_damaged_file_is_compiled_anew_and_mended(
    kept: Path, tmp_path: Path, ending: str, damage: Callable[[bytes], bytes]
) -> None:
    folder = shutil.copytree(kept, tmp_path / "copy")  # with the times that numba looks at
    (path,) = (folder / "__pycache__").glob(f"*.{ending}")
    path.write_bytes(damage(path.read_bytes()))
    found = run_kernel(folder)
    assert found == "42 0\n" if ending == "nbc" else found.startswith("42 ")
    assert run_kernel(folder) == "42 1\n"


CALLER = """
import numba
from llvmlite import binding
from troupe.kernel_cache import distrust_cache
distrust_cache()
read = []
parse = binding.parse_bitcode
binding.parse_bitcode = lambda *words: read.append(words) or parse(*words)
import numpy as np
import troupe
from sensors.grid import locate
with troupe.Simulation("wander", controllers=False) as simulation:
    simulation.step(2)
    simulation.readings("laser")
print(len(read))
@numba.njit
def located(frame, x, y):
    return locate(frame, x, y)
frame = np.array([0.0, 0.0, 1.0, 8.0, 8.0, 1.0, 1.0, 1.0])
print(located(frame, 2.5, 3.5) == locate.py_func(frame, 2.5, 3.5), len(read) > 0)
"""


def test_a_kept_kernel_is_its_machine_code_until_another_is_compiled_with_it() -> None:
    """In a process of its own: what is read once is there for all that come later."""
    done = python(CALLER)
    assert done.stdout.splitlines() == ["0", "True True"], done.stderr


def test_a_seal_tells_what_is_damaged_and_nothing_of_what_has_none() -> None:
    data = bytes(range(256))
    assert is_whole(data)
    assert is_whole(b"")
    assert is_whole(sealed(data))
    assert not is_whole(flipped(sealed(data)))


NOWHERE = """
import sys
from numba.core import caching
caching.CacheImpl._locator_classes = []  # as where no folder can be written
sys.argv = ["troupe", *{words!r}]
from troupe.__main__ import main
main()
"""


def test_where_nothing_can_be_kept_it_is_said_with_what_to_do() -> None:
    done = python(NOWHERE.format(words=["warm"]))
    assert (done.returncode, done.stderr) == (1, f"{NOT_KEPT}\n")
    assert "NUMBA_CACHE_DIR" in NOT_KEPT
    done = python(NOWHERE.format(words=["disperse", "--grid", "3x3", "--door", "1,1"]))
    assert done.returncode == 0, done.stderr
    assert done.stderr == f"compiling (it may take a minute); {NOT_KEPT}\n"
