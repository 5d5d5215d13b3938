"""Every design of the gallery in motion, for a small picture each."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np

from stepwell import files
from stepwell.base import ExtraError, Ints
from stepwell.files import WrittenProgram
from stepwell.mechanism import Chain
from stepwell.robot import Robot
from stepwell.statics import Path
from stepwell.studio.panels.designs.gallery import names
from stepwell.studio.panels.motions import arrays_of, cells_of, drawn, events_of
from stepwell.studio.panels.robots import walking
from stepwell.studio.wire import Ask, Design, View

LONG = True
# So many samples of a motion look smooth in a small picture, beside the ends of its branches.
_SAMPLES = 60
_BLOCKS = ("drive", "travel", "angle", "segment", "direction")


def answer(_design: Design, ask: Ask) -> View:
    """One motion after another in the order of the gallery, and at last how many they were."""
    ask.close()
    for name in names():
        ask.show(_moving(name))
    return View({"count": len(names())})


def _moving(name: str) -> View:
    """The program of a design, or the full cycle where it has none; a robot's walk."""
    tables = tomllib.loads(files.preset_text(name))
    file = files.loads_tables(tables)
    design, written = file.subject, file.program
    if not isinstance(design, Robot):
        return _chain(name, design, written, tables["chain"]["cell"])
    try:
        return _robot(name, design)
    except ExtraError:
        # It takes MuJoCo to walk; a leg moves without.
        return _chain(name, design.legs[0].chain, None, [])


def _chain(
    name: str, chain: Chain, written: WrittenProgram | None, cells: list[dict[str, Any]]
) -> View:
    result = chain.cycle() if written is None else written.on(chain)
    path = drawn(result.path)
    rows = _few(path)
    snaps = [
        {"kind": event["kind"], "sample": int(np.searchsorted(rows, event["sample"]))}
        for event in events_of(result.path.events, path)
        if event["kind"] == "snap"
    ]
    arrays = arrays_of(path)
    return View(
        {
            "name": name,
            "sequence": str(result.sequence),
            "cells": cells_of(chain),
            # They say what an element is.
            "tables": cells,
            "events": snaps,
        },
        {block: arrays[block][rows] for block in _BLOCKS},
    )


def _few(path: Path) -> Ints:
    """The samples of a small picture: the ends of all branches, and between them steps alike."""
    step = np.abs(np.diff(path.travel, axis=0) / path.chain.full_travels).max(axis=1)
    step[path.branch[1:] != path.branch[:-1]] = 0.0
    along = np.concatenate([[0.0], np.cumsum(step)])
    part = np.floor(_SAMPLES * along / max(along[-1], 1e-9))
    keep = np.ones(len(part), bool)
    keep[1:-1] = (part[1:-1] != part[:-2]) | (path.branch[1:-1] != path.branch[:-2])
    keep[:-1] |= path.branch[1:] != path.branch[:-1]
    return np.flatnonzero(keep)


def _robot(name: str, robot: Robot) -> View:
    moving = walking(robot)
    sequences = {leg.name: str(leg.chain.cycle().sequence) for leg in robot.legs}
    told = [f"{leg} {sequence}" for leg, sequence in sequences.items()]
    alike = len(set(sequences.values())) == 1
    sequence = sequences[robot.legs[0].name] if alike else ", ".join(told)
    return View({"name": name, "sequence": sequence, **moving.header}, moving.blocks)
