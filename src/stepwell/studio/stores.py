"""Studies in the folder of the server, and their computation."""

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any

from stepwell.base import InputError, need
from stepwell.studies import Study, opened
from stepwell.studio.ask import Ask

# Limits: listed names, bytes of a store's description, letters of a name.
_MOST, _LONGEST, _NAME = 500, 1 << 23, 200


def home(ask: Ask) -> Path:
    """The folder of studies; an error if this server has none."""
    need("studies")
    if ask.studies is None:
        raise InputError("studies: this server keeps none; start it by `stepwell studio`.")
    return ask.studies


def stores(folder: Path) -> dict[str, Path]:
    """The stores in the folder, newest first."""
    try:
        inside = [one for one in folder.iterdir() if not one.name.startswith(".")]
        held = [one for one in inside if (one / "zarr.json").is_file() and one.name.isprintable()]
        held.sort(key=lambda one: -(one / "zarr.json").stat().st_mtime)
    except OSError:
        return {}
    return {one.name: one for one in held[:_MOST]}


def store_named(ask: Ask, name: str) -> Path:
    """The store with this name, which must be listed."""
    store = stores(home(ask)).get(name)
    if store is None:
        raise InputError(f"ask.name = {name[:60]!r}: there is no such study.")
    return store


def study_of(ask: Ask) -> Study:
    """The study with the requested name."""
    return opened(store_named(ask, ask.text("name", _NAME)))


def described(place: Path) -> dict[str, Any]:
    """The description in a store, read without Zarr; empty if there is none."""
    try:
        with (place / "zarr.json").open("rb") as file:
            held = json.loads(file.read(_LONGEST))
        asked = held["attributes"]["stepwell_study"]
        count, chunk = asked["designs"].get("count"), int(asked["chunk"])
        count, chunks = (count, -(-count // chunk)) if isinstance(count, int) else (None, None)
        return {"what": str(asked["what"]), "count": count, "chunks": chunks}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, ZeroDivisionError):
        return {}


_LONGEST_WORDS = 4000  # bytes of the last output of a command


class _Run:
    def __init__(self, store: Path):
        self._log: IO[bytes] | None = TemporaryFile()  # noqa: SIM115  until the command has ended
        self._stopped, self._said = False, ""
        # The command of a terminal, in its own process session, so that all of
        # its processes can be ended together, and a Ctrl-C reaches the server only.
        words = [sys.executable, "-P", "-m", "stepwell", "sweep", "resume", str(store)]
        none = subprocess.DEVNULL
        self.process = subprocess.Popen(
            words, stdin=none, stdout=none, stderr=self._log, start_new_session=True
        )
        if hasattr(os, "setpriority"):
            with suppress(OSError):  # it has ended already
                os.setpriority(
                    os.PRIO_PROCESS, self.process.pid, 5
                )  # answers to a drag have priority

    @property
    def going(self) -> bool:
        """Whether the run is active."""
        if self.process.poll() is None:
            return True
        if self._log is not None:
            self._said = "" if self._stopped or not self.process.returncode else _last(self._log)
            self._log.close()
            self._log = None
        return False

    @property
    def said(self) -> str:
        """The error at its end; "" if it is active, finished or was stopped."""
        return "" if self.going else self._said

    def end(self) -> None:
        """End all processes now; only unwritten chunks are lost."""
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
    log.seek(max(0, log.seek(0, os.SEEK_END) - _LONGEST_WORDS))
    lines = [line.strip() for line in log.read().decode("utf-8", "replace").split("\n")]
    last = next((line for line in reversed(lines) if line), "")
    return "".join(filter(str.isprintable, last)) or "It ended before it was done."


# The last run of each store.
_RUNS: dict[Path, _Run] = {}


def begin(store: Path) -> None:
    """Compute the missing designs of a store, unless this is already running."""
    for other in [one for one, run in _RUNS.items() if run.going]:
        if other == store:
            return
        # Two runs would compete for the cores.
        raise InputError(f"{other.name} is being computed: stop it first, or wait for it.")
    _RUNS[store] = _Run(store)


def stop(store: Path) -> bool:
    """Stop the run of this server on a store; returns whether there was one."""
    run = _RUNS.get(store)
    if run is None or not run.going:
        return False
    run.end()
    return True


def how(store: Path) -> tuple[bool, str]:
    """Whether this server computes the store, and the reason of a failure."""
    run = _RUNS.get(store)
    return (False, "") if run is None else (run.going, run.said)


def end_studies() -> None:
    """Stop all runs of this server."""
    for run in _RUNS.values():
        run.end()
