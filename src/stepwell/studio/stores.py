"""The studies in the server's own folder, and those that this server computes."""

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

# Names that are listed, bytes of a store's description that are read, letters of a name.
_MOST, _LONGEST, _NAME = 500, 1 << 23, 200


def home(ask: Ask) -> Path:
    """The folder in which studies are kept; refused if this server keeps none."""
    need("studies")
    if ask.studies is None:
        raise InputError("studies: this server keeps none; start it by `stepwell studio`.")
    return ask.studies


def stores(folder: Path) -> dict[str, Path]:
    """What is in the folder and looks like a store, the newest first."""
    try:
        inside = [one for one in folder.iterdir() if not one.name.startswith(".")]
        held = [one for one in inside if (one / "zarr.json").is_file() and one.name.isprintable()]
        held.sort(key=lambda one: -(one / "zarr.json").stat().st_mtime)
    except OSError:
        return {}
    return {one.name: one for one in held[:_MOST]}


def store_named(ask: Ask, name: str) -> Path:
    """The store of that name, which must be one of those that are listed."""
    store = stores(home(ask)).get(name)
    if store is None:
        raise InputError(f"ask.name = {name[:60]!r}: there is no such study.")
    return store


def study_of(ask: Ask) -> Study:
    """The study whose name is asked for."""
    return opened(store_named(ask, ask.text("name", _NAME)))


def described(place: Path) -> dict[str, Any]:
    """What a store says of itself, read without Zarr; empty where it says nothing."""
    try:
        with (place / "zarr.json").open("rb") as file:
            held = json.loads(file.read(_LONGEST))
        asked = held["attributes"]["stepwell_study"]
        count, chunk = asked["designs"].get("count"), int(asked["chunk"])
        count, chunks = (count, -(-count // chunk)) if isinstance(count, int) else (None, None)
        return {"what": str(asked["what"]), "count": count, "chunks": chunks}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, ZeroDivisionError):
        return {}


_LONGEST_WORDS = 4000  # bytes of what a command said last


class _Run:
    def __init__(self, store: Path):
        self._log: IO[bytes] | None = TemporaryFile()  # noqa: SIM115  until the command has ended
        self._stopped, self._said = False, ""
        # The same command that a terminal would be given. Its session is its own, so that all of
        # its processes can be ended together, and a Ctrl-C is the server's alone.
        words = [sys.executable, "-P", "-m", "stepwell", "sweep", "resume", str(store)]
        none = subprocess.DEVNULL
        self.process = subprocess.Popen(
            words, stdin=none, stdout=none, stderr=self._log, start_new_session=True
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
    log.seek(max(0, log.seek(0, os.SEEK_END) - _LONGEST_WORDS))
    lines = [line.strip() for line in log.read().decode("utf-8", "replace").split("\n")]
    last = next((line for line in reversed(lines) if line), "")
    return "".join(filter(str.isprintable, last)) or "It ended before it was done."


# By its store what was begun last.
_RUNS: dict[Path, _Run] = {}


def begin(store: Path) -> None:
    """Compute what is missing in a store, if that is not going on already."""
    for other in [one for one, run in _RUNS.items() if run.going]:
        if other == store:
            return
        # Two at once would take each other's cores.
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
    """End all that this server has begun."""
    for run in _RUNS.values():
        run.end()
