"""Recordings of our own test machine, for the commands of the lab."""

from pathlib import Path

import numpy as np

from lab.exports import ASKED
from lab.machine import Array, pair, saved, tension, unit
from stepwell.files import preset, rig_toml
from stepwell.lab import Rig
from stepwell.mechanism import Chain

(_CELL,) = preset("paper-cell-10-0").cells
_ANCHORS = {"MB": (0.0, 0.0), "MM": (0.010, 0.0), "MT": (0.020, 0.0)}
# Two letters, across and up, as the authors name their recordings.
_MANY = {
    f"M{up}{across}": (x, y)
    for up, y in (("L", 0.015), ("M", 0.0), ("R", -0.015))
    for across, x in (("B", 0.0), ("M", 0.010), ("T", 0.020))
}


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


def unclear(folder: Path) -> None:
    """A log without names and units."""
    (folder / "log.csv").write_text(ASKED["no header"][0], "utf-8")


def on_a_rig(folder: Path) -> None:
    """The same, and the rigs of two machines, one of which cannot be."""
    cells(folder)
    rig = Rig(0.070, 1.02, -0.0002, 0.0003, 0.0003, 0.06)
    (folder / "rig.toml").write_text(rig_toml(rig), "utf-8")
    odd = "stretch = 0\ncompliance_mm_per_N = -1\nbars_mm = 70\n"
    (folder / "odd.toml").write_text(odd, "utf-8")


def rubber(folder: Path) -> None:
    """Unit cells with many anchors whose bands lose work going back, under rubber/."""
    for unloading, way in ((False, "out"), (True, "back")):
        told = {"unloading": unloading, "friction": 0.02}
        saved(unit(f"{way}/friction_1.txt", None, **told), folder / "rubber")
        for code, q in _MANY.items():
            cell = _CELL.with_anchors(q=q)
            saved(
                unit(f"{way}/1unit_{code}_1.txt", cell, **told, loss=0.2, noise=0.002, seed=1),
                folder / "rubber",
            )


def _rubber(stroke: Array) -> Array:
    """Tension [N] that softens and stiffens, so that no law has more numbers than can be told."""
    longer = stroke + 0.005
    return 35 * longer * (1 - 20 * longer + 400 * longer**2)


def clip(folder: Path) -> None:
    """A snapping element, loaded and unloaded, as clip.csv."""
    travel = np.append(there := np.linspace(0.0, 11.0, 600), there[::-1])
    t = travel / 10.0
    force = 3.0 * t - 9.0 * t**2 + 7.0 * t**3 + 0.05 * np.repeat([1.0, -1.0], 600)
    force += np.random.default_rng(0).normal(0.0, 0.01, 1200)
    rows = np.column_stack([travel, force])
    header = "Displacement (mm),Force (N)"
    np.savetxt(folder / "clip.csv", rows, "%.4f", ",", header=header, comments="")


def bands(folder: Path) -> None:
    """Tension tests of three samples in two cycles, under bands/."""
    rng = np.random.default_rng(0)
    for sample in (1, 2, 3):
        for cycle in (5, 6):
            noise = rng.normal(0, 0.003, 4000)
            run = tension(sample, cycle, _rubber, noise=noise)
            saved(run, folder / "bands")
