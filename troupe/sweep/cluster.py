"""Runs on a cluster: tasks given to the workers of a dask scheduler, records taken from them.

Each of dask's workers keeps worker processes of ours, as a sweep on one machine does: dask's own
threads cannot be ended when a run takes too long, and their crash would be dask's.
"""

from __future__ import annotations

import queue
import threading
import uuid
from collections.abc import Callable, Iterator
from typing import Any

from troupe.sweep.pool import LOOK, MOST_TRIES, Record, Task, Worker, run_one, unfinished
from troupe.usage import UsageError

WINDOW = 2
"""Tasks under way for each of the cluster's threads."""

CONNECT = 30
"""Seconds that the scheduler has to answer."""

idle: list[Worker] = []
lock = threading.Lock()


def run_here(task: Task, timeout: float | None) -> Record:
    """Run a task in a process of this machine: what dask's workers are given to do."""
    with lock:
        mine = [idle.pop()] if idle else []
    record = run_one(task, timeout, mine)
    with lock:
        idle.extend(mine)
    return record


def run_on_cluster(
    tasks: Iterator[Task],
    address: str,
    timeout: float | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Iterator[Record]:
    """Run all tasks on the cluster of the scheduler at `address`; their records, as they come.

    A task whose worker dies is given to another one. Raises UsageError where there is no
    scheduler, and for a cluster whose workers cannot run Troupe.
    """
    try:
        from distributed import Client, KilledWorker  # noqa: PLC0415 - an extra
    except ImportError:
        raise UsageError(
            "--dask needs the extra `cluster`: pip install 'troupe-sim[cluster]'"
        ) from None
    try:
        client: Any = Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise UsageError(f"--dask {address}: no scheduler answers ({error})") from None
    ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
    under_way: dict[str, tuple[Task, Any]] = {}

    def threads() -> int:
        return sum(client.nthreads().values())

    def submit() -> bool:
        task = next(tasks, None)
        if task is None:
            return False
        key = f"{task['name']}-{uuid.uuid4().hex}"  # two sweeps may have the same run
        future = client.submit(run_here, task, timeout, key=key, pure=False)
        under_way[key] = (task, future)
        future.add_done_callback(ended.put)
        return True

    with client:
        room = max(WINDOW * threads(), 1)
        while len(under_way) < room and submit():
            pass
        while under_way and not stop():
            try:
                future = ended.get(timeout=LOOK)
            except queue.Empty:
                continue
            task, _ = under_way.pop(future.key)
            yield record_of(future, task, KilledWorker)
            submit()


def record_of(future: Any, task: Task, killed: type[Exception]) -> Record:
    """What has become of a task that dask has ended."""
    error = future.exception() if future.status != "cancelled" else RuntimeError("cancelled")
    if error is None:
        record: Record = future.result()
        return record
    if isinstance(error, killed):
        reason = f"{MOST_TRIES} or more of the cluster's workers died with it"
        return unfinished(task, "crashed", reason, [])
    raise UsageError(f"--dask: a worker of the cluster cannot run it: {error!r}")
