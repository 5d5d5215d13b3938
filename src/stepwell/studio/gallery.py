"""The designs of the gallery, and their motions in small.

The motions are computed in advance and come with the package: no page waits for them, and robots
move without the simulator. `make motions` computes them again.
"""

from __future__ import annotations

import hashlib
import tomllib
import zlib
from functools import cache
from pathlib import Path as Place
from typing import Any

import numpy as np

from stepwell import files, statics
from stepwell.base import ExtraError, Ints, most
from stepwell.mechanism import Chain
from stepwell.robot import Robot
from stepwell.studio.ask import PageDesign, View
from stepwell.studio.message import packed, unpacked
from stepwell.studio.motion import arrays_of, cells_of, drawn, events_of, layout_of

# Motions by the text of the design of which each was computed.
_FILE = Place(__file__).with_name("gallery.motions")
# Of coordinates in mm, angles in degrees and forces in N; pictures are small.
_DECIMALS = 4

# The groups in the order of the page.
_GROUPS = ("paper", "further", "elements", "robots")


@cache
def listed() -> list[dict[str, Any]]:
    """Name, title, kind, group, number of cells, and whether it has parts, of each design."""
    entries = [_entry(name, title) for name, title in files.presets().items()]
    return sorted(entries, key=lambda one: _GROUPS.index(one["group"]))


def _entry(name: str, title: str) -> dict[str, Any]:
    tables = tomllib.loads(files.preset_text(name))
    legs = tables.get("leg", [])
    own = legs[0].get("chain", {}) if legs else {}
    cells = own.get("cell") or tables["chain"]["cell"]
    kind, group = ("robot", "robots") if legs else ("chain", "further")
    # Cells of levers have bands, and bands have anchors.
    if not legs and not all("p_mm" in cell or "bands" in cell for cell in cells):
        group = "elements"
    elif name.startswith("paper-"):
        group = "paper"
    entry = {"name": name, "title": title, "kind": kind, "group": group, "cells": len(cells)}
    # Of lever cells; whether they can be built is computed when the panel opens.
    parts = kind == "chain" and group != "elements" and len(cells) <= most("built_cells")
    return {**entry, "parts": parts}


# Samples of a motion in a small picture, in addition to the ends of its branches.
_SAMPLES = 60
_BLOCKS = ("drive", "travel", "tension", "pull", "segment", "direction")


@cache
def motions() -> dict[str, View]:
    """The motions that come with the package, by name; none of a design that was changed since."""
    kept, texts = _kept(), {one["name"]: files.preset_text(one["name"]) for one in listed()}
    motions = {name: kept.get(_digest(text)) for name, text in texts.items()}
    return {name: motion for name, motion in motions.items() if motion is not None}


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _kept() -> dict[str, View]:
    """All motions of the file by digest of the design's text."""
    if not _FILE.is_file():
        return {}
    data = zlib.decompress(_FILE.read_bytes())
    kept: dict[str, View] = {}
    while data:
        size = int.from_bytes(data[:8], "little")
        header, blocks = unpacked(data[8 : 8 + size])
        for key in ("v", "type", "seq", "ok", "blocks"):
            header.pop(key)
        kept[header.pop("digest")] = View(header, blocks)
        data = data[8 + size :]
    return kept


def keep() -> None:
    """Compute all motions again and write them into the package."""
    data = b""
    for one in listed():
        text = files.preset_text(one["name"])
        view = moving(one["name"], tomllib.loads(text))
        blocks = {name: _rounded(block) for name, block in view.blocks.items()}
        motion = packed("", 0, View({**view.header, "digest": _digest(text)}, blocks))
        data += len(motion).to_bytes(8, "little") + motion
    _FILE.write_bytes(zlib.compress(data, 9))


def _rounded(block: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.round(block, _DECIMALS) + 0.0 if block.dtype.kind == "f" else block


def opened(tables: dict[str, Any]) -> tuple[Chain | Robot, files.WrittenProgram | None]:
    """The chain or robot of a design that the page can show, and its program."""
    design = PageDesign(tables)
    _ = design.chain  # within the limit of the page
    return design.read.subject, design.program


def moving(name: str, tables: dict[str, Any]) -> View:
    """The motion of a design: its cycle or program; of a robot the second cycle of its walk."""
    design, program = opened(tables)
    if not isinstance(design, Robot):
        return _chain(name, design, program)
    try:
        return _robot(name, design)
    except ExtraError:
        # A walk needs MuJoCo; the chain of a leg does not.
        return _chain(name, design.legs[0].chain, None)


def _chain(name: str, chain: Chain, written: files.WrittenProgram | None) -> View:
    result = chain.cycle() if written is None else written.on(chain)
    path = drawn(result.path)
    rows, arrays = _few(path), arrays_of(path)
    snaps = [
        {"kind": event["kind"], "sample": int(np.searchsorted(rows, event["sample"]))}
        for event in events_of(result.path.events, path)
        if event["kind"] == "snap"
    ]
    header = {
        "name": name,
        "sequence": str(result.sequence),
        "cells": cells_of(chain, range(len(chain))),
    }
    header |= {"layout": layout_of(result.path), "events": snaps}
    return View(header, {block: arrays[block][rows] for block in _BLOCKS})


def _few(path: statics.Path) -> Ints:
    """Indices of samples for a small picture: ends of branches, and equal steps between them."""
    step = np.abs(np.diff(path.travel, axis=0) / path.chain.full_travels).max(axis=1)
    step[path.branch[1:] != path.branch[:-1]] = 0.0
    along = np.concatenate([[0.0], np.cumsum(step)])
    part = np.floor(_SAMPLES * along / max(along[-1], 1e-9))
    keep = np.ones(len(part), bool)
    keep[1:-1] = (part[1:-1] != part[:-2]) | (path.branch[1:-1] != path.branch[:-2])
    keep[:-1] |= path.branch[1:] != path.branch[:-1]
    return np.flatnonzero(keep)


def _robot(name: str, robot: Robot) -> View:
    from stepwell.studio.scene import walking

    moving = walking(robot)
    sequences = {leg.name: str(leg.chain.cycle().sequence) for leg in robot.legs}
    sequence, *others = set(sequences.values())
    if others:
        sequence = ", ".join(f"{leg} {own}" for leg, own in sequences.items())
    return View({"name": name, "sequence": sequence, **moving.header}, moving.blocks)


if __name__ == "__main__":
    keep()
