"""Long work in other threads, with a limit of its effort."""

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

import numpy as np

from stepwell.base import Ints, Progress, notify
from stepwell.kernels.fingerprint import kernel

R = TypeVar("R")

_LOOK_AFTER = 0.1  # s; an unlimited wait would ignore Ctrl-C on some systems
# Blocks for each core; the shortest block is the longest one over _SHARES.
_BLOCKS_A_CORE, _SHARES = 8, 16


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def beside(
    run: Callable[[], R], stop: Callable[[], object], look: Callable[[], object] = lambda: None
) -> R:
    """Run run() in another thread and return its result.

    If this thread is interrupted, it calls `stop`, which has to end the work soon, and waits.
    `look` is called ten times a second; an exception in it stops the work too.
    """
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(run)
        try:
            return _result(running, look)
        except BaseException:
            stop()
            raise


def in_blocks(
    run: Callable[[int, int], object], count: int, size: int, progress: Progress = None
) -> None:
    """Call run(begin, end) for stretches that cover 0..count, in any order, on all cores.

    Compiled kernels run in parallel; interpreted ones take turns. One call covers at most `size`:
    Ctrl-C waits for the calls that have begun. Less than a sixteenth of that is not worth a thread.
    `progress` is called from time to time with (done, count).
    """
    # The first block runs here, so that compilation happens once and reacts to Ctrl-C. The other
    # cores wait for it, so it is the shortest.
    least = max(1, size // _SHARES)
    run(0, min(least, count))
    if count <= least:
        return
    with ThreadPoolExecutor(cores()) as pool:
        # Several blocks per core, so that other cores take over the blocks of a slow one.
        step = min(size, max(least, -(-(count - least) // (_BLOCKS_A_CORE * cores()))))
        ends = range(least + step, count + step, step)
        runs = [pool.submit(run, end - step, min(end, count)) for end in ends]
        try:
            for running, end in zip(runs, ends, strict=True):
                _result(running)
                notify(progress, min(end, count), count)
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _result(running: Future[R], look: Callable[[], object] = lambda: None) -> R:
    while True:
        try:
            return running.result(_LOOK_AFTER)
        except TimeoutError:
            if running.done():
                return running.result()
            look()


# Effort of the present stroke, and its limit. Lowering the limit from another thread stops a run.
SPENT, MOST = 0, 1
UNLIMITED = int(np.iinfo(np.int64).max)


def watched(run: Callable[[Ints], R], *, long: bool = True, most: int = UNLIMITED) -> R:
    """The result of run(effort), in another thread if it may be long, so that Ctrl-C works."""
    effort = np.array([0, most])
    if not long:
        return run(effort)
    return beside(lambda: run(effort), lambda: end_early(effort))


def end_early(effort: Ints) -> None:
    """Make the kernels that spend this effort return soon."""
    effort[MOST] = -1


@kernel
def overspent(effort: Ints, looks: int) -> bool:
    """Add to the number of force evaluations; returns whether it exceeds the limit."""
    effort[SPENT] += looks
    return effort[SPENT] > effort[MOST]
