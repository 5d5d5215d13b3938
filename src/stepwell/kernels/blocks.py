"""Many alike things, a block at a time, on all cores, with an ear for Ctrl-C."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

_LOOK_AFTER = 0.1  # s
_MOST_BLOCKS = 1000


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_blocks(
    run: Callable[[int, int], object],
    count: int,
    size: int,
    progress: Callable[[float, float], None] | None = None,
) -> None:
    """Call run(begin, end) for stretches that cover 0..count, on all cores.

    Compiled kernels work side by side; interpreted ones take turns.

    Args:
        run: works on the stretch from `begin` to before `end`; stretches may run in any order.
        count: how many there are.
        size: how many one call takes at least.
        progress: called now and then with (done, count).
    """
    size = max(size, -(-count // _MOST_BLOCKS))
    # The first one runs here: what has to be compiled is compiled once, where Ctrl-C is heard.
    run(0, min(size, count))
    if count <= size:
        return
    with ThreadPoolExecutor(cores()) as pool:
        runs = [pool.submit(run, a, min(a + size, count)) for a in range(size, count, size)]
        try:
            for number, running in enumerate(runs):
                while True:
                    # A wait without an end would not hear Ctrl-C everywhere.
                    try:
                        running.result(_LOOK_AFTER)
                        break
                    except TimeoutError:
                        continue
                if progress is not None:
                    progress(min((number + 2) * size, count), count)
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
