"""What the options of `troupe sweep` say on how it is carried out, checked all at once."""

from __future__ import annotations

import os

from troupe.sweep.session import How


def how_of(
    jobs: int | None,
    shard: str | None,
    timeout: float | None,
    retry_failed: bool,
    dask: str | None,
    quiet: bool,
    mistakes: list[str],
) -> How:
    """How to run; what is wrong with an option is added to `mistakes`, and the option left out."""
    if jobs is not None and jobs < 1:
        mistakes.append(f"--jobs {jobs}: must be 1 or more")
    if jobs is not None and dask is not None:
        mistakes.append("--jobs and --dask: a scheduler's workers say how many run at a time")
    if timeout is not None and not 0 < timeout < 1e9:
        mistakes.append(f"--timeout {timeout:g}: must be above 0 and below 1e9")
    part = (1, 1)
    if shard is not None:
        first, _, number = shard.partition("/")
        if first.isdecimal() and number.isdecimal() and 1 <= int(first) <= int(number):
            part = (int(first), int(number))
        else:
            mistakes.append(f"--shard {shard}: must be I/N, from 1/N to N/N")
    return How(jobs or cores(), part, timeout, retry_failed, dask, quiet)


def cores() -> int:
    """The processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
