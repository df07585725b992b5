"""What is wanted of a run in pictures: the options that `troupe run` and `troupe render` share."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from troupe.interrupts import last_act
from troupe.usage import UsageError

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.filming import Film

Size = str | tuple[int, int]


@dataclass(frozen=True)
class Filmed:
    """A video, a picture, both or neither; what is None is as the world has it.

    Raises UsageError for options of what is not to be made.
    """

    video: str | Path | None = None
    fps: float | None = None
    speed: float | None = None
    size: Size | None = None
    show: str | Iterable[str] | None = None
    picture: str | Path | None = None
    at: float | None = None

    def __post_init__(self) -> None:
        of_video = {"video fps": self.fps, "video speed": self.speed}
        of_both = {"video size": self.size, "video show": self.show}
        nothing = self.video is None and self.picture is None
        for options, lacking in ((of_video, self.video is None), (of_both, nothing)):
            for name, given in options.items():
                if given is not None and lacking:
                    raise UsageError(
                        f"{name}: there is no video to be made; name its file, as run.mp4"
                    )
        if self.at is not None and self.picture is None:
            raise UsageError("at: there is no picture to be made; name its file, as run.png")

    @property
    def wanted(self) -> bool:
        """Whether anything is to be made."""
        return self.picture is not None or self.video is not None

    def open(
        self,
        loaded: LoadedWorld,
        ending: contextlib.ExitStack,
        say: Callable[[str], None],
        begun: Callable[[], bool],
    ) -> Film | None:
        """Open what is wanted; None where nothing is. Raises VideoError for what cannot be.

        `ending`: what may have to be done at the end goes there. Where that comes with an error
        before all has `begun`, no file stays.
        """
        if not self.wanted:
            return None
        from sim.filming import Film, open_recorder, open_still  # noqa: PLC0415
        from sim.video.layers import parse_layers  # noqa: PLC0415
        from sim.video.projection import parse_size  # noqa: PLC0415

        size = None if self.size is None else parse_size(self.size)
        show = parse_layers(self.show) if isinstance(self.show, str) else self.show
        still = recorder = None
        if self.picture is not None:
            still = open_still(Path(self.picture), loaded, at=self.at, size=size, show=show)
        if self.video is not None:
            from sim.video.encode import abandon  # noqa: PLC0415

            path = Path(self.video)
            ending.enter_context(last_act(partial(abandon, path.resolve())))
            recorder = open_recorder(
                path, loaded, fps=self.fps, speed=self.speed, size=size, show=show
            )

            def give_up(kind: object, *_: object) -> None:
                if kind and not begun():
                    recorder.close()  # no frames: no file

            ending.push(give_up)
            if recorder.notice:
                say(recorder.notice)
        return Film(recorder, still)

    def shortfall(self, film: Film | None) -> str | None:
        """What there is to say of a picture of a moment that the run did not come to."""
        taken = None if film is None or film.still is None else film.still.time
        if taken is None or self.at is None or taken >= self.at - 1e-9:
            return None
        return f"{self.picture}: the run ended at {taken:g} s, and that is what the picture shows"
