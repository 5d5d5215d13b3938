"""Recordings of our own test machine, for the commands of the lab."""

from pathlib import Path

import numpy as np

from lab.machine import pair, saved, tension, unit
from stepwell.files import preset
from stepwell.mechanism import Chain

(_CELL,) = preset("paper-cell-10-0").cells
_ANCHORS = {"MB": (0.0, 0.0), "MM": (0.010, 0.0), "MT": (0.020, 0.0)}


def cells(folder: Path) -> None:
    """Unit cells, a pair and the friction of both, and a file that is none, under data/."""
    data = folder / "data"
    saved(unit("1unit/friction/friction_1.txt", None, seed=1), data)
    for code, q in _ANCHORS.items():
        cell = _CELL.with_anchors(q=q)
        for k in (1, 2):
            saved(unit(f"1unit/x/1unit_{code}_{k}.txt", cell, noise=0.002, seed=k), data)
    chain = Chain([_CELL, _CELL.with_anchors(q=(0.020, 0.0))])
    saved(pair("2unit_00_11/x/2unit_MMT_1.txt", chain, seed=1), data)
    saved(pair("2unit_00_11/f/2unit_friction_1.txt", None), data)
    (data / "broken.txt").write_bytes(b"\x00\x01")


def bands(folder: Path) -> None:
    """Tension tests of three samples in two cycles, under bands/."""
    rng = np.random.default_rng(0)
    for sample in (1, 2, 3):
        for cycle in (5, 6):
            noise = rng.normal(0, 0.003, 4000)
            run = tension(sample, cycle, lambda u: 28.5 * (u + 0.005), noise=noise)
            saved(run, folder / "bands")
