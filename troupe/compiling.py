"""Kernels that are compiled while a command runs: it says so, and for how long is known."""

from __future__ import annotations

import sys
from collections.abc import Callable
from time import perf_counter
from types import TracebackType
from typing import Any, Self

NOTICE = "compiling the kernels (only once; it may take a minute) ..."


def tell(line: str) -> None:
    """Print a line on standard error."""
    print(line, file=sys.stderr, flush=True)


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
                self.say(NOTICE)
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
