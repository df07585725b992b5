"""Processes that run tasks: started once, fed, watched for their end and their time limit."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

from troupe.sweep.task import ended, killed_from_outside
from troupe.sweep.versions import ROOT, machine

AHEAD = 3
"""Tasks that a worker has besides the one it runs, where runs are short: it need not wait then."""

SHORT = 0.2
"""Seconds of such a run. Of longer ones nobody has two while another has none."""

MOST_TRIES = 3
"""A run whose worker dies, or whose controller is killed from outside, is tried again so often."""

MOST_STILLBORN = 8
"""Workers one after the other that end before they can work: then something is wrong with them."""

ENDING = 10.0
"""Seconds that a process may take to end once it has closed its output: Python takes a while."""

LOOK = 0.2
"""Seconds between two looks at the time limits, and at whether to stop."""

Task = dict[str, Any]
Record = dict[str, Any]


class Broken(Exception):
    """Workers cannot be started; says what the last of them printed."""


class Worker:
    """One process, the tasks that it has been given, and when it began with the first of them."""

    def __init__(self) -> None:
        self.tasks: deque[Task] = deque()
        self.ready = False
        self.ahead = 0
        self.began = 0.0
        self.pending = b""
        self.errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the process
        self.process = subprocess.Popen(
            # -P: this file's folder must not become a place to import from
            [sys.executable, "-P", str(Path(__file__).with_name("worker.py")), str(ROOT)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
            start_new_session=True,  # a Ctrl-C at the terminal is for the sweep alone
        )

    def fileno(self) -> int:
        assert self.process.stdout is not None
        return self.process.stdout.fileno()

    def give(self, task: Task) -> None:
        """Have one more task done; a worker that is dead is found so when it is read."""
        if not self.tasks:
            self.began = time.monotonic()
        self.tasks.append(task)
        assert self.process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.write(json.dumps(task).encode() + b"\n")
            self.process.stdin.flush()

    def take(self) -> list[tuple[Task, Record]] | None:
        """The tasks that are done, with their records; None when the process has ended."""
        data = os.read(self.fileno(), 1 << 20)
        if not data:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(ENDING)  # else we would kill it, and not know how it ended
            return None
        *whole, self.pending = (self.pending + data).split(b"\n")
        done = []
        for one in whole:
            self.began = time.monotonic()
            if not self.ready:
                self.ready = True
                continue
            record = json.loads(one)
            self.ahead = AHEAD if record.get("seconds", SHORT) < SHORT else 0
            done.append((self.tasks.popleft(), record))
        return done

    def is_late(self, timeout: float | None) -> bool:
        """Whether the run that it has is over its time limit."""
        busy = timeout is not None and self.ready and bool(self.tasks)
        return busy and timeout is not None and time.monotonic() - self.began > timeout

    def end(self) -> None:
        """Kill the process; its controllers end with it."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            with contextlib.suppress(OSError):
                if pipe is not None:
                    pipe.close()

    def last_words(self) -> list[str]:
        """What an ended worker has printed last."""
        self.errors.seek(0, os.SEEK_END)
        self.errors.seek(max(0, self.errors.tell() - 4000))
        return self.errors.read().decode(errors="replace").splitlines()[-20:]


def unfinished(task: Task, outcome: str, reason: str, output: list[str]) -> Record:
    """The record of a run that has no result."""
    return {**ended(task, outcome, reason), "machine": machine(), "output": output}


def how_ended(code: int) -> tuple[str, str]:
    """A run's outcome and its reason, from the end of the worker that had it."""
    if code == -signal.SIGKILL:
        return "out_of_memory", "the system killed the worker (signal 9): most likely for memory"
    if code < 0:
        return "crashed", f"the worker was ended by signal {-code}"
    return "crashed", f"the worker ended with exit code {code}"


def lost(task: Task, worker: Worker) -> tuple[Task | None, Record | None]:
    """A task whose worker has died: the task to be tried again, or its record."""
    again = repeated(task)
    if again is not None:
        return again, None
    ended = how_ended(worker.process.returncode)
    return None, unfinished(task, *ended, worker.last_words())


def repeated(task: Task) -> Task | None:
    """The task once more after a deed from outside, None if that has been enough."""
    deaths = task.get("deaths", 0) + 1
    if deaths >= MOST_TRIES:
        return None
    return {**task, "tries": task["tries"] + 1, "deaths": deaths}


def too_late(task: Task, timeout: float | None) -> Record:
    """The record of a run that was ended for its time."""
    return unfinished(task, "timeout", f"took longer than {timeout:g} s of wall time", [])


def run_all(
    tasks: Iterator[Task],
    jobs: int,
    timeout: float | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Iterator[Record]:
    """Run all tasks in `jobs` processes; their records, as they come.

    A run that takes longer than `timeout` wall-clock seconds is ended. `stop()` is asked often;
    when it is true everything ends at once, and so it does when the iterator is closed. Raises
    Broken where no process can be made that works.
    """
    again: deque[Task] = deque()
    workers: list[Worker] = []
    stillborn = 0
    with selectors.DefaultSelector() as selector:

        def refill(worker: Worker) -> None:
            while len(worker.tasks) <= worker.ahead:
                task = again.popleft() if again else next(tasks, None)
                if task is None:
                    return
                worker.give(task)

        def start() -> None:
            worker = Worker()
            workers.append(worker)
            selector.register(worker, selectors.EVENT_READ)
            refill(worker)

        def lose(worker: Worker) -> None:
            selector.unregister(worker)
            workers.remove(worker)
            worker.end()
            again.extend(worker.tasks)

        try:
            for _ in range(jobs):
                start()
            while again or any(worker.tasks for worker in workers):
                if stop():
                    return
                for key, _ in selector.select(LOOK):
                    worker: Any = key.fileobj
                    done = worker.take()
                    for task, record in done or ():
                        repeat = repeated(task) if killed_from_outside(record) else None
                        if repeat is None:
                            yield record
                        else:
                            again.append(repeat)
                    if done is not None:
                        stillborn = 0
                        refill(worker)
                        continue
                    blamed = worker.tasks.popleft() if worker.ready and worker.tasks else None
                    stillborn += not worker.ready
                    lose(worker)
                    if stillborn >= MOST_STILLBORN:
                        raise Broken("\n".join(worker.last_words()))
                    if blamed is not None:
                        repeat, given_up = lost(blamed, worker)
                        if repeat is not None:
                            again.append(repeat)
                        if given_up is not None:
                            yield given_up
                    start()
                for worker in [one for one in workers if one.is_late(timeout)]:
                    late = worker.tasks.popleft()
                    lose(worker)
                    yield too_late(late, timeout)
                    start()
        finally:
            for worker in workers:
                worker.end()


def run_one(task: Task, timeout: float | None, idle: list[Worker]) -> Record:
    """Run one task in an idle worker, which is idle again afterwards, or in a new one."""
    while True:
        worker = idle.pop() if idle else Worker()
        worker.give(task)
        done: list[tuple[Task, Record]] | None = []
        with selectors.DefaultSelector() as selector:
            selector.register(worker, selectors.EVENT_READ)
            while done is not None and not done and not worker.is_late(timeout):
                if selector.select(LOOK):
                    done = worker.take()
        if done:
            idle.append(worker)
            repeat = repeated(task) if killed_from_outside(done[0][1]) else None
            if repeat is None:
                return done[0][1]
            task = repeat
            continue
        worker.end()
        if done is not None:
            return too_late(task, timeout)
        repeat, given_up = lost(task, worker)
        if given_up is not None:
            return given_up
        assert repeat is not None
        task = repeat
