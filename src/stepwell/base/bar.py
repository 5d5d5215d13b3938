"""Progress bars for long work, in notebooks and on terminals only."""

import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from time import monotonic
from typing import Any, TypeVar

T = TypeVar("T")
# Called with (done, total) during the work; None if no progress is reported.
Progress = Callable[[int, int], None] | None
Shows = Callable[[float, float], None]  # What a bar is called with.


def notify(progress: Callable[[T, T], None] | None, done: T, total: T) -> None:
    """Call `progress` with (done, total), unless it is None."""
    if progress is not None:
        progress(done, total)


def tracked(items: Collection[T], progress: Progress) -> Iterator[T]:
    """The items one by one; the number done is reported before each item and at the end."""
    for done, item in enumerate(items):
        notify(progress, done, len(items))
        yield item
    notify(progress, len(items), len(items))


# Time between two updates of the bar [s], and the window over which the pace is averaged [s]: long
# enough for work in large pieces.
_EVERY, _REMEMBERED = 0.1, 600.0
# Time between two lines of progress where there is no terminal [s].
_LINE_EVERY = 30.0


@contextmanager
def on_terminal(label: str | Callable[[], str]) -> Iterator[Shows | None]:
    """A function to call with (done, total); None if standard error is no terminal.

    The bar shows the fraction done and the estimated remaining time. It is written to standard
    error, so that it never mixes with results, and is removed at the end. A label that is a
    function is called at each update.
    """
    text = label if callable(label) else lambda: label
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, speed_estimate_period=_REMEMBERED) as shown:
        task = shown.add_task(text(), total=None)
        last = -_EVERY

        def update(done: float, total: float) -> None:
            nonlocal last
            now = monotonic()
            if done >= total or now - last >= _EVERY:
                shown.update(task, completed=done, total=total, description=text())
                last = now

        yield update


def in_lines(label: Callable[[], str]) -> Shows:
    """A function to call with (done, total) for a line on standard error every half minute."""
    begun = last = monotonic()

    def update(done: float, total: float) -> None:
        nonlocal last
        now = monotonic()
        if now - last >= _LINE_EVERY and 0 < done < total and sys.stderr is not None:
            left = _span((now - begun) * (total / done - 1.0))
            sys.stderr.write(f"{label()}: {done / total:.0%}, about {left} left\n")
            sys.stderr.flush()
            last = now

    return update


class _Bar:
    """One bar at a time; less `done` than before starts a new bar."""

    def __init__(self) -> None:
        self._open = ExitStack()
        self._show: Shows | None = None
        self._done: float | None = None

    def __call__(self, done: float, total: float) -> None:
        if self._done is None or done < self._done:
            self._open.close()
            shown = in_notebook() if _notebook() else on_terminal("working")
            self._show = self._open.enter_context(shown)
        self._done = done
        if self._show is not None:
            self._show(done, total)
        if done >= total:
            self._open.close()
            self._show = self._done = None


@contextmanager
def in_notebook() -> Iterator[Shows]:
    """A function to call with (done, total) for a bar below a notebook's cell.

    The bar is plain HTML and is removed at the end. A saved notebook keeps it only if the work was
    interrupted.
    """
    display: Any = sys.modules["IPython"].display
    place = display.display(display.HTML(""), display_id=True)
    begun = last = monotonic()

    def update(done: float, total: float) -> None:
        nonlocal last
        now = monotonic()
        if now - last >= _EVERY:
            place.update(display.HTML(_html(done, total, now - begun)))
            last = now

    yield update
    place.update(display.HTML(""))


def _html(done: float, total: float, spent: float) -> str:
    rest = f", about {_span(spent * (total / done - 1.0))} left" if done > 0 else ""
    return (
        '<div style="display:flex;gap:0.8em;align-items:center">'
        f'<progress value="{done:g}" max="{total:g}" style="width:16em"></progress>'
        f"<span>{done / total:.0%}{rest}</span></div>"
    )


def _span(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _notebook() -> bool:
    """Whether this process is the kernel of a notebook; an IPython shell is a terminal."""
    if "IPython" not in sys.modules:
        return False
    shell: Any = sys.modules["IPython"].get_ipython()
    return shell is not None and hasattr(shell, "kernel")


_bar = _Bar()


def bar(done: float, total: float) -> None:
    """Show a progress bar; pass it as `progress=`, as in `chain.yields(progress=sw.bar)`.

    In a notebook the bar is below the cell, on a terminal on standard error, with the remaining
    time. It is removed at the end. Without a notebook or terminal nothing is shown. Less `done`
    than before starts a new bar.
    """
    _bar(done, total)
