"""Stores for the studio's tests, filled without another process."""

from __future__ import annotations

from pathlib import Path

import stepwell as sw
from stepwell import files
from stepwell.studies import (
    Axis,
    How,
    Space,
    Study,
    atlas_blocks as blocks,
    begun,
    opened,
    planned_study,
)
from stepwell.studies.fill import fill


def filled(study: Study) -> Study:
    """The study with all of its chunks."""
    begun(study)
    for chunk in study.missing():
        fill(str(study.folder), study.identity, chunk)
    return opened(study.folder)


def plane(home: Path, count: int, folder: Path | None = None) -> Study:
    """Cycles of the paper's leg over the paper's map, chunks of 32; nothing is written."""
    axes = Axis("outer.q.x", 0.0, 0.020), Axis("outer.q.y", -0.015, 0.015)
    leg = files.preset("paper-forward")
    space = Space(axes, How.SOBOL, count)
    return planned_study(leg, "cycle", space, folder or home / "plane.zarr", chunk=32)


def small_atlas(folder: Path) -> Study:
    """An atlas of two of the paper's cells, which takes some tenths of a second."""
    cell = sw.Cell(sw.Band(p=(-0.01, 0.0), q=(0.01, 0.0), stiffness=28.5, rest_length=0.01))
    chain = sw.Chain([cell] * 2)
    axes = tuple(
        axis
        for k in (1, 2)
        for axis in (Axis(f"{k}.q.x", 0.0, 0.020), Axis(f"{k}.q.y", -0.015, 0.015))
    )
    given = {"drive": "stroke"}
    return filled(
        planned_study(chain, "atlas", blocks(2, axes, 5000, 0), folder, given=given, chunk=1)
    )
