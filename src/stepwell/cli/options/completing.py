"""What the shell offers where a design, a robot or an arena is typed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path


def designs(incomplete: str) -> list[str]:
    """Presets that begin so, behind `preset:`, and design files."""
    from stepwell.files import presets

    names = (f"preset:{name}" for name in presets())
    return [*_begun(names, incomplete), *_files(incomplete, ".toml")]


def robots(incomplete: str) -> list[str]:
    """The robots among the presets, by their names alone or behind `preset:`, and files."""
    from stepwell.files import presets

    before = "preset:" if incomplete.startswith("preset:") else ""
    names = (f"{before}{name}" for name in presets() if name.startswith("robot-"))
    return [*_begun(names, incomplete), *_files(incomplete, ".toml")]


def presets(incomplete: str) -> list[str]:
    """Presets that begin so."""
    from stepwell import files

    return _begun(iter(files.presets()), incomplete)


def arenas(incomplete: str) -> list[str]:
    """Arenas that begin so, and files of arenas."""
    from stepwell import files

    return [*_begun(iter(files.arenas()), incomplete), *_files(incomplete, ".toml", ".txt")]


def results(incomplete: str) -> list[str]:
    """Results that have a JSON Schema."""
    from stepwell.accounts import schema_kinds

    return _begun(iter(schema_kinds()), incomplete)


def _begun(names: Iterator[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]


def _files(incomplete: str, *endings: str) -> list[str]:
    """Files of these kinds, and folders to look into."""
    folder = incomplete.rpartition("/")[0]
    place = Path(f"{folder}/" if folder or incomplete.startswith("/") else ".")
    try:
        found = sorted(place.iterdir())
    except OSError:
        return []
    before = incomplete[: len(incomplete) - len(incomplete.rpartition("/")[2])]
    names = [
        f"{before}{one.name}{'/' if one.is_dir() else ''}"
        for one in found
        if one.suffix in endings or one.is_dir()
    ]
    return [name for name in names if name.startswith(incomplete)]
