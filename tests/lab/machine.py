"""A test machine of our own: recordings with known truth, written as Bluehill writes them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stepwell.lab import Recording
from stepwell.mechanism import Band, Cell, Chain

Array = NDArray[np.float64]

HEADER = "Raw Data\r\nTime Displacement Force\r\n(s) (mm) (N)\r\n"
SPEED = 0.667e-3  # [m/s]
RATE = 25.0  # [Hz]


def export(file: Path, time: Array, stroke: Array, force: Array) -> Path:
    """Write a recording [s], [m], [N] as raw data."""
    file.parent.mkdir(parents=True, exist_ok=True)
    rows = zip(time, stroke * 1e3, force, strict=True)
    text = "".join(f"{t:.4f} {u:.4f} {f:.4f}\r\n" for t, u, f in rows)
    file.write_bytes((HEADER + text).encode("ascii"))
    return file


def saved(recording: Recording, folder: Path) -> Path:
    """Write a recording into a folder, under its own source."""
    return export(folder / recording.source, recording.time, recording.stroke, recording.force)


def there(length: float) -> Array:
    """Strokes of one way [m]."""
    return np.linspace(0.0, length, max(20, int(length / SPEED * RATE)))


def recording(source: str, stroke: Array, force: Array) -> Recording:
    """A recording at the machine's rate."""
    return Recording(source, np.arange(len(stroke)) / RATE, stroke, force)


def tension(
    sample: int, cycle: int, curve, *, length: float = 0.045, loss: float = 0.25, noise: Array
) -> Recording:
    """A band pulled and let go: force `curve(stroke)`, less by `loss` on the way back."""
    up = there(length)
    force = np.concatenate([curve(up), (1 - loss) * curve(up[-2::-1])])
    stroke = np.concatenate([up, up[-2::-1]])
    return recording(f"Samp{sample}_45mm_{cycle}.txt", stroke, force + noise[: len(stroke)])


def baseline(travel: Array, friction: float) -> Array:
    """Friction of a cell against its travel [N]: it rises by half of itself."""
    return friction * (1 + 0.5 * travel / 0.020)


def unit(
    source: str,
    cell: Cell | None,
    *,
    friction: float = 0.05,
    unloading: bool = False,
    loss: float = 0.0,
    loss_length: float = 0.003,
    noise: float = 0.0,
    seed: int = 0,
) -> Recording:
    """A unit cell driven one way, with slack at the start; no cell for the friction baseline."""
    shape = cell or Cell(Band((0.0, 0.0), (0.02, 0.0)))
    way = there(shape.full_travel)
    travel = shape.full_travel - way if unloading else way
    theta = shape.angle(travel)
    force = np.zeros(len(travel))
    for band in cell.bands if cell else ():
        length = band.length(theta, shape.lever)
        shorter = np.maximum.accumulate(length) - length
        kept = 1 - loss * (1 - np.exp(-shorter / loss_length))
        force += band.force(theta, shape.lever) * kept
    sign = -1.0 if unloading else 1.0
    force += sign * baseline(travel, friction)
    force *= np.minimum(1.0, way / 50e-6)
    force += np.random.default_rng(seed).normal(0.0, noise, len(force)) if noise else 0.0
    return recording(source, -way if unloading else way, force)


def pair(
    source: str,
    chain: Chain | None,
    *,
    friction: tuple[float, float] = (0.02, 0.06),
    unloading: bool = False,
    noise: float = 0.002,
    seed: int = 0,
) -> Recording:
    """Two cells driven one way by the model with friction; no chain for the baseline.

    Without bands the cell with less friction moves first.
    """
    cells = [Cell(Band((0.0, 0.0), (0.02, 0.0)))] * 2 if chain is None else list(chain.cells)
    full = sum(cell.full_travel for cell in cells)
    way = there(full)
    stroke = full - way if unloading else way
    if chain is None:
        first = int(np.argmin(friction))
        half = cells[0].full_travel
        early = stroke > full - half if unloading else stroke <= half
        force = np.where(early, friction[first], friction[1 - first])
        force = -force if unloading else force
    else:
        rubbing = Chain([replace(c, friction=f) for c, f in zip(cells, friction, strict=True)])
        turns = [full, 0.0] if unloading else [0.0, full]
        path = rubbing.path(turns, start="11" if unloading else "00").resampled(400)
        order = slice(None, None, -1) if unloading else slice(None)
        force = np.interp(stroke, path.stroke[order], path.force[order])
    force = force + np.random.default_rng(seed).normal(0.0, noise, len(force))
    return recording(source, -way if unloading else way, force)
