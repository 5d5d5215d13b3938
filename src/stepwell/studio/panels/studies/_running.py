"""Studies that this server has begun: a command each, which goes on when the page is closed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

from stepwell.base import InputError

_LONGEST = 4000  # bytes of what a command said last


class _Run:
    """A command at work on a store, and what it says."""

    def __init__(self, store: Path):
        self._log: IO[bytes] | None = TemporaryFile()  # noqa: SIM115  until the command has ended
        self._stopped, self._said = False, ""
        # The same command that a terminal would be given. Its session is its own, so that all of
        # its processes can be ended together, and a Ctrl-C is the server's alone.
        words = [sys.executable, "-P", "-m", "stepwell", "sweep", "resume", str(store)]
        self.process = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=self._log,
            start_new_session=True,
        )
        if hasattr(os, "setpriority"):
            with suppress(OSError):  # it has ended already
                os.setpriority(os.PRIO_PROCESS, self.process.pid, 5)  # the pointer goes first

    @property
    def going(self) -> bool:
        """Whether it is at work."""
        if self.process.poll() is None:
            return True
        if self._log is not None:
            self._said = "" if self._stopped or not self.process.returncode else _last(self._log)
            self._log.close()
            self._log = None
        return False

    @property
    def said(self) -> str:
        """What it ended with; "" where it goes on, is done, or was stopped."""
        return "" if self.going else self._said

    def end(self) -> None:
        """End all of it now; the store loses what was not written yet and nothing else."""
        if not self.going:
            return
        self._stopped = True
        if hasattr(os, "killpg"):
            with suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
        else:
            self.process.kill()
        self.process.wait()
        assert not self.going


def _last(log: IO[bytes]) -> str:
    """The last line that was written."""
    log.seek(max(0, log.seek(0, os.SEEK_END) - _LONGEST))
    lines = [line.strip() for line in log.read().decode("utf-8", "replace").split("\n")]
    last = next((line for line in reversed(lines) if line), "")
    return "".join(filter(str.isprintable, last)) or "It ended before it was done."


# By its store what was begun last.
_RUNS: dict[Path, _Run] = {}


def begin(store: Path) -> None:
    """Compute what is missing in a store; nothing where that is going on.

    Raises:
        ValueError: another study is being computed: two at once would take each other's cores.
    """
    for other, run in _RUNS.items():
        if run.going:
            if other == store:
                return
            raise InputError(f"{other.name} is being computed: stop it first, or wait for it.")
    _RUNS[store] = _Run(store)


def stop(store: Path) -> bool:
    """End what this server has begun on a store; whether there was anything."""
    run = _RUNS.get(store)
    if run is None or not run.going:
        return False
    run.end()
    return True


def how(store: Path) -> tuple[bool, str]:
    """Whether this server computes it, and if it failed, why."""
    run = _RUNS.get(store)
    return (False, "") if run is None else (run.going, run.said)


def end_studies() -> None:
    """End all of them, since the server ends."""
    for run in _RUNS.values():
        run.end()
