"""The file that a video goes to, checked before anything runs."""

from __future__ import annotations

import os
from pathlib import Path

from sim.video.errors import VideoError


def check_target(path: Path | str, *, ending: str = ".mp4", what: str = "video") -> Path:
    """The path with links followed; raises VideoError where no video could be written there.

    `ending` and `what` are others for a picture.

    An existing file is opened for appending, which changes nothing; one that was not there
    is made and removed again.
    """
    path = Path(path)
    if path.suffix.lower() != ending:
        given = f"not in {path.suffix}" if path.suffix else "and this one has no ending"
        raise VideoError(f"{path}: a {what}'s name must end in {ending}, {given}")
    target = path.resolve()
    if not target.parent.is_dir():
        raise VideoError(f"{path}: there is no folder {target.parent}; make it first")
    if target.is_dir():
        raise VideoError(f"{path}: is a folder; name a file in it, such as {path / f'run{ending}'}")
    existed = target.exists()
    try:
        with target.open("ab"):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise VideoError(f"{path}: cannot be written ({reason}); choose another place") from error
    if not existed:
        os.unlink(target)
    return target
