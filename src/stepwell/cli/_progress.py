"""A progress bar on the terminal, and silence everywhere else."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

# Between two looks at the bar [s]; and for how long the pace is remembered, so that work in large
# pieces has an estimate too [s].
_EVERY, _REMEMBERED = 0.1, 600.0


@contextmanager
def progress(label: str) -> Iterator[Callable[[float, float], None] | None]:
    """What to call with (done, total); None where nobody is looking.

    The bar tells how much is done and how long the rest will take. It goes to standard error, so
    that it never mixes with results, and vanishes when done.
    """
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, speed_estimate_period=_REMEMBERED) as bar:
        task = bar.add_task(label, total=None)
        last = -_EVERY

        def update(done: float, total: float) -> None:
            nonlocal last
            now = monotonic()
            if done >= total or now - last >= _EVERY:
                bar.update(task, completed=done, total=total)
                last = now

        yield update
