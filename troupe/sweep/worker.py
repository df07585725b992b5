"""A worker's process: takes tasks as lines of JSON, gives records as lines of JSON.

It is started by exec and lives for many runs, so that what is slow to load and the kernels are
loaded once. It may start controllers' processes of its own. When whoever gives it tasks goes away,
however that ends, so does it, and the controllers with it.
"""

from __future__ import annotations

import faulthandler
import json
import os
import queue
import sys
import threading
from typing import Any

# The packages are found by the path that is given, before they can be imported.
# ruff: noqa: PLC0415


def main() -> None:
    """`worker.py ROOT`: work until standard input ends."""
    sys.path.insert(0, sys.argv[1])
    faulthandler.enable()
    asked = os.fdopen(os.dup(0), encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)  # what the user's code reads is no task
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what it prints is no answer
    tasks: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def listen() -> None:
        for line in asked:
            tasks.put(json.loads(line))
        os._exit(0)  # also in the middle of a run: the fork server sees it, and ends the rest

    threading.Thread(target=listen, daemon=True).start()
    from sim.strictjson import dumps
    from troupe.kernel_cache import distrust_cache
    from troupe.sweep.task import Worlds, run_task

    distrust_cache()
    worlds = Worlds()
    answers.write("{}\n")  # from now on there is work done
    answers.flush()
    while True:
        record = run_task(tasks.get(), worlds)
        if record.get("outcome") == "interrupted":
            os._exit(0)  # a signal was meant for this process: it gives no record
        answers.write(dumps(record) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
