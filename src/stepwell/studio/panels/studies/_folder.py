"""The stores in the server's folder, by their names; a path that comes from the page is none."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from stepwell.base import InputError, need
from stepwell.studies import Study, opened
from stepwell.studio.wire import Ask

# Names that are listed, and bytes of a store's description that are read.
_MOST, _LONGEST = 500, 1 << 23
_NAME = 200


def home(ask: Ask) -> Path:
    """The folder in which studies are kept.

    Raises:
        ExtraError: the extra studies is not installed.
        ValueError: this server keeps none.
    """
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
    """The store of that name, which must be one of those that are listed.

    Raises:
        ValueError: there is none.
    """
    found = stores(home(ask)).get(name)
    if found is None:
        raise InputError(f"ask.name = {name[:60]!r}: there is no such study.")
    return found


def study_of(ask: Ask) -> Study:
    """The study whose name is asked for.

    Raises:
        ValueError: there is none, or it cannot be read.
    """
    return opened(store_named(ask, ask.text("name", _NAME)))


def described(place: Path) -> dict[str, Any]:
    """What a store says of itself, read without Zarr; empty where it says nothing."""
    try:
        with (place / "zarr.json").open("rb") as file:
            held = json.loads(file.read(_LONGEST))
        asked = held["attributes"]["stepwell_study"]
        count, chunk = asked["designs"].get("count"), asked["chunk"]
        return {
            "what": str(asked["what"]),
            "count": int(count) if isinstance(count, int) else None,
            "chunks": -(-int(count) // int(chunk)) if isinstance(count, int) else None,
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError, ZeroDivisionError):
        return {}
