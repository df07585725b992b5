"""Kernels compile anywhere, and never from an old source."""

import os
import subprocess
import sys
from pathlib import Path

from numba.core import caching

from sensors.compiled import compiled, forget_stale_code
from sensors.rays import cast, cast_fans
from sensors.scene import Scene


def double(x: float) -> float:
    return 2.0 * x


def test_a_kernel_compiles_where_no_cache_can_be_written(monkeypatch):
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    assert compiled(double)(4.0) == 8.0


def test_compiled_code_is_forgotten_when_any_source_of_the_package_changes(tmp_path):
    cache = tmp_path / "__pycache__"
    cache.mkdir()
    source = tmp_path / "one.py"
    source.write_text("x = 1")
    forget_stale_code(tmp_path)
    (cache / "one.nbi").write_text("index")
    forget_stale_code(tmp_path)
    assert (cache / "one.nbi").exists()
    source.write_text("x = 12")
    forget_stale_code(tmp_path)
    assert not (cache / "one.nbi").exists()


def test_compiled_code_is_forgotten_when_a_folder_that_it_draws_upon_changes(tmp_path):
    package, other = tmp_path / "package", tmp_path / "other"
    for folder in (package, other):
        folder.mkdir()
        (folder / "one.py").write_text("x = 1")
    forget_stale_code(package, other)
    index = package / "__pycache__" / "one.nbi"
    index.write_text("index")
    forget_stale_code(package, other)
    assert index.exists()
    (other / "one.py").write_text("x = 12")
    forget_stale_code(package, other)
    assert not index.exists()


def test_the_cache_of_a_first_run_is_kept_where_python_itself_makes_no_cache(tmp_path):
    """As under PYTHONDONTWRITEBYTECODE: numba makes the folder after we have looked for it."""
    (tmp_path / "one.py").write_text("x = 1")
    forget_stale_code(tmp_path)
    cache = tmp_path / "__pycache__"
    cache.mkdir(exist_ok=True)  # as numba does
    (cache / "one.nbi").write_text("index")
    forget_stale_code(tmp_path)
    assert (cache / "one.nbi").exists()


def test_the_mark_is_never_seen_half_written(tmp_path, monkeypatch):
    """It is written under another name; what cannot be put in its place changes nothing."""
    source = tmp_path / "one.py"
    source.write_text("x = 1")
    forget_stale_code(tmp_path)
    mark = tmp_path / "__pycache__" / "kernels.sha256"
    before = mark.read_text()
    source.write_text("x = 12")

    def refuse(self, target):
        raise OSError("no")

    monkeypatch.setattr(Path, "replace", refuse)
    forget_stale_code(tmp_path)
    assert mark.read_text() == before


def test_a_folder_that_cannot_be_written_is_left_alone(tmp_path):
    (tmp_path / "__pycache__").write_text("a file, where a folder should be")
    forget_stale_code(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["__pycache__"]


def test_one_machine_code_serves_all_calls():
    """Each further signature would cost seconds on the first call with it."""
    scene = Scene()
    cast(scene, [[0, 0, 0]], [-1], 1.0, 3, 5.0)
    known = list(cast_fans.signatures)  # of other tests in this process too
    scene.add_segments(scene.add_entity(), [[1, -1, 1, 1]])
    scene.refresh()
    cast(scene, [(0, 0, 0), (1, 2, 3)], [-1, 0], 1, 3, 5)
    assert list(cast_fans.signatures) == known


def test_importing_a_colour_does_not_import_numba():
    code = "import sys, sensors.colors; sys.exit('numba' in sys.modules)"
    root = Path(__file__).resolve().parents[2]
    environment = os.environ | {"PYTHONPATH": str(root)}
    assert (
        subprocess.run([sys.executable, "-c", code], check=False, env=environment).returncode == 0
    )
