"""Kernels that are compiled while a command runs: it says so, and for how long is known."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from types import TracebackType
from typing import Any, Self

from troupe.kernel_cache import cache_folder, distrust_cache
from troupe.warm import NOT_KEPT, tell

NOTICE = "compiling a kernel that is new here (only once; it may take a minute) ..."
NOTICE_EACH_TIME = f"compiling (it may take a minute); {NOT_KEPT}"


class Compiling:
    """Listens to numba while it is entered. What comes out of numba's cache makes no event.

    `say` is given one line when the first kernel is compiled. A kernel that another one calls is
    compiled within that one's time, and by the same thread: numba has one lock.
    """

    def __init__(self, say: Callable[[str], None] = tell) -> None:
        self.say = say
        self.spans: list[tuple[float, float]] = []
        self._told = False
        self._depth = 0
        self._began = 0.0
        self._installed: Any = None

    def on_start(self, event: object) -> None:
        """numba begins to compile."""
        if self._depth == 0:
            self._began = perf_counter()
            if not self._told:
                self._told = True
                self.say(NOTICE if cache_folder() is not None else NOTICE_EACH_TIME)
        self._depth += 1

    def on_end(self, event: object) -> None:
        """numba has compiled, or failed to."""
        self._depth -= 1
        if self._depth == 0:
            self.spans.append((self._began, perf_counter()))

    def after(self, moment: float) -> float:
        """Seconds spent compiling since `moment` of perf_counter; they are told once."""
        spans, self.spans = self.spans, []
        return sum(end - begin for begin, end in spans if begin >= moment)

    def __enter__(self) -> Self:
        from numba.core import event  # noqa: PLC0415 - slow to load

        distrust_cache()
        parent = self

        class Ears(event.Listener):
            def on_start(self, event: object) -> None:
                parent.on_start(event)

            def on_end(self, event: object) -> None:
                parent.on_end(event)

        self._installed = event.install_listener("numba:compile", Ears())
        self._installed.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._installed.__exit__(kind, error, trace)
