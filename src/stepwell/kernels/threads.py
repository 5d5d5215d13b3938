"""Long work beside the thread that asked for it, and what it may cost."""

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

import numpy as np

from stepwell.base import Ints, Progress, notify
from stepwell.kernels.fingerprint import kernel

R = TypeVar("R")

_LOOK_AFTER = 0.1  # s; a wait without an end would not hear Ctrl-C everywhere
# Blocks for each core, as long as none is shorter than this share of the longest.
_BLOCKS_A_CORE, _SHARES = 8, 16


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def beside(
    run: Callable[[], R], stop: Callable[[], object], look: Callable[[], object] = lambda: None
) -> R:
    """What run() returns, from a thread of its own.

    `stop` makes it end soon, and is called where this thread is interrupted, which waits for that
    end. `look` is called ten times a second; what it raises stops the work too.
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

    Compiled kernels work side by side; interpreted ones take turns. One call takes at most `size`:
    Ctrl-C waits for the calls that have begun. Less than a sixteenth of that is not worth a thread.
    `progress` is called now and then with (done, count).
    """
    # The first one runs here: what has to be compiled is compiled once, where Ctrl-C is heard. The
    # other cores wait for it, so it is the shortest.
    least = max(1, size // _SHARES)
    run(0, min(least, count))
    if count <= least:
        return
    with ThreadPoolExecutor(cores()) as pool:
        # Several a core: one that is slow, or busy elsewhere, leaves the rest to the others.
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


# What the present stroke has cost; how much it may cost at most. Lowering the second from another
# thread stops a run.
SPENT, MOST = 0, 1
UNLIMITED = int(np.iinfo(np.int64).max)


def watched(run: Callable[[Ints], R], *, long: bool = True, most: int = UNLIMITED) -> R:
    """What run(effort) returns; beside this thread where it may be long, for Ctrl-C's sake."""
    effort = np.array([0, most])
    if not long:
        return run(effort)
    return beside(lambda: run(effort), lambda: end_early(effort))


def end_early(effort: Ints) -> None:
    """Make the kernels that spend this effort return soon."""
    effort[MOST] = -1


@kernel
def overspent(effort: Ints, looks: int) -> bool:
    """Count more looks; whether they are now too many."""
    effort[SPENT] += looks
    return effort[SPENT] > effort[MOST]
