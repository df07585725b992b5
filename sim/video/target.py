"""The file that a video goes to, checked before anything runs."""

from __future__ import annotations

import os
import stat
from collections.abc import Sequence
from pathlib import Path

from sim.video.errors import VideoError


def check_target(
    path: Path | str, *, endings: Sequence[str] = (".mp4",), what: str = "video"
) -> Path:
    """The path with links followed; raises VideoError where no video could be written there.

    `endings` and `what` are others for a picture.

    An existing file is opened for appending, which changes nothing; one that was not there
    is made and removed again.
    """
    path = Path(path)
    if path.suffix.lower() not in endings:
        given = f"not in {path.suffix}" if path.suffix else "and this one has no ending"
        raise VideoError(f"{path}: a {what}'s name must end in {' or '.join(endings)}, {given}")
    try:
        target = path.resolve()
        if target.is_symlink():  # where links go round in a circle, Python from 3.13 on stops there
            raise RuntimeError
        if not target.parent.is_dir():
            raise VideoError(f"{path}: there is no folder {target.parent}; make it first")
        if target.is_dir():
            example = path / f"run{endings[0]}"
            raise VideoError(f"{path}: is a folder; name a file in it, such as {example}")
        existed = target.exists()
        # Opening a pipe would wait for a reader, and a video is not written from end to end.
        if existed and not (target.is_file() or stat.S_ISCHR(target.stat().st_mode)):
            raise VideoError(f"{path}: is no plain file (a pipe or the like); choose another name")
        with target.open("ab"):
            pass
        if not existed:
            os.unlink(target)
    except RuntimeError as error:
        raise VideoError(f"{path}: is a link that leads back to itself; remove it first") from error
    except VideoError:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise VideoError(f"{path}: cannot be written ({reason}); choose another place") from error
    return target
