"""A progress bar on the terminal, and silence everywhere else."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from stepwell.base import on_terminal

WRITING = "writing"
Progress = Callable[[float, float], None]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, with a line about what had been done."""


@contextmanager
def progress(
    label: str, *, kept: str = "", note: Callable[[], str] = str
) -> Iterator[Progress | None]:
    """What to call with (done, total); None where nobody is looking.

    The bar tells how much is done and how long the rest will take. It goes to standard error, so
    that it never mixes with results, and vanishes when done.

    Args:
        label: what is going on.
        note: what is told behind it, asked anew as work goes on.
        kept: what an interruption leaves and how to go on; nothing is written otherwise.

    Raises:
        Interrupted: in place of a KeyboardInterrupt, with one line that tells all this.
    """
    reached = ""
    try:
        with on_terminal(lambda: label + note()) as shown:

            def update(done: float, total: float) -> None:
                nonlocal reached
                reached = f", {done:.0f} of {total:.0f} done" if total > 2 else ""
                if shown is not None:
                    shown(done, total)

            yield None if shown is None else update
    except Interrupted:
        raise
    except KeyboardInterrupt:
        left = kept or "nothing was written"
        if label == WRITING:
            left = "the folder is as it was, or says that it is incomplete"
        raise Interrupted(f"Interrupted ({label}{reached}); {left}.") from None
