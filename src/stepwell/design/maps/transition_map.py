"""The transition map: which pathway a pair of cells takes, for every place of one anchor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import __version__
from stepwell.concave import closed, simple, sweep
from stepwell.design.maps.pathways import BY_ORDER, IMPOSSIBLE, UNSOLVED
from stepwell.design.parameters import axis, moved, refuse_far, require_places, which
from stepwell.kernels import in_blocks
from stepwell.mechanism import Chain
from stepwell.sequences import Pathway, cycle
from stepwell.statics import StaticsError

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]

# Below this gap, in units of k r, no maker and no rounding error can tell the order.
TIE = 1e-9
_CODES = tuple(Pathway)
_BLOCK = 20_000  # designs that one core takes at a time
_BYTES = 27  # of a place in `_Fields`


@dataclass(frozen=True)
class _Fields:
    """What a map holds, (ny, nx) each."""

    pathway: NDArray[np.int8]
    snap_loading: NDArray[np.float64]
    snap_unloading: NDArray[np.float64]
    margin: NDArray[np.float64]
    monostable: NDArray[np.bool_]
    degenerate: NDArray[np.bool_]

    @classmethod
    def unsolved(cls, shape: tuple[int, int]) -> _Fields:
        return cls(
            np.full(shape, UNSOLVED, np.int8),
            np.full(shape, np.nan),
            np.full(shape, np.nan),
            np.full(shape, np.nan),
            np.zeros(shape, bool),
            np.zeros(shape, bool),
        )


def transition_map(
    chain: Chain,
    cell: int | str = 1,
    *,
    x: ArrayLike,
    y: ArrayLike,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """The pathway and the snaps of a pair of cells, for every anchor q of one of them.

    Designs of two concave cells under a rigid actuator are solved in closed form; all others,
    one by one, by the general engine (a few milliseconds each). `attrs` counts both.

    Args:
        chain: two cells.
        cell: the one whose anchor moves, 0 or 1 or its name.
        x, y: (nx,), (ny,) rising places of its anchor q on the outer block [m].
        progress: called with (done, total) while the general engine works.

    Returns:
        Dataset with dims ("y", "x") and coordinates in m:
        pathway, int8, codes in its attrs flag_values and flag_meanings, among them
        "impossible" where the band's ends would meet and "unsolved" where the engine gave up;
        snap_loading, snap_unloading, stroke [m] of the first snap, NaN where there is none;
        margin, min(|F0in - F0out|, |F1in - F1out|) over k r of the cell that stays: zero
        exactly on a boundary, NaN where the general engine had to decide;
        monostable, whether the moved cell is stable in one state only;
        degenerate, whether the design sits on a boundary (margin below 1e-9, or the engine
        met a tie).

    Raises:
        ValueError: a chain that is no pair, axes that do not rise, or more places than the limit.

    Source: Kamp et al. 2024, Fig. 2C; closed form: theory page, "Two cells".
    """
    cell = which(chain, cell)
    x, y = axis("x", x, 1), axis("y", y, 1)
    require_places(len(x), len(y), _BYTES)
    refuse_far(chain, cell, x, y)
    fields = _Fields.unsolved((len(y), len(x)))
    _in_closed_form(fields, chain, cell, x, y)
    waiting = np.argwhere(fields.pathway == UNSOLVED).tolist()
    for done, (row, column) in enumerate(waiting):
        if progress is not None:
            progress(done, len(waiting))
        _by_engine(fields, chain, cell, (row, column), float(x[column]), float(y[row]))
    if progress is not None:
        progress(len(waiting), len(waiting))
    return _labelled(fields, chain, cell, x, y, asked=len(waiting))


def _in_closed_form(fields: _Fields, chain: Chain, cell: int, x: Floats, y: Floats) -> None:
    fixed, moving = closed(chain.cells[1 - cell]), simple(chain.cells[cell])
    if np.isfinite(chain.actuator_stiffness) or fixed is None or moving is None:
        return
    order = np.full(fields.pathway.shape, -1, np.int8)
    strokes = fields.snap_loading, fields.snap_unloading
    p = chain.cells[cell].bands[0].p
    out = (order, *strokes, fields.margin, fields.monostable)

    def rows(begin: int, end: int) -> None:
        sweep(x, y[begin:end], p, fixed, moving, cell, *(field[begin:end] for field in out))

    size = sweep.block(max(1, _BLOCK // len(x)), x, y)
    in_blocks(rows, len(y), size)
    # The last code is for -1, what is still open.
    codes = np.array([_CODES.index(p) for p in BY_ORDER] + [UNSOLVED], np.int8)
    fields.pathway[:] = codes[order]
    fields.degenerate[:] = fields.margin < TIE


def _by_engine(
    fields: _Fields, chain: Chain, cell: int, at: tuple[int, int], x: float, y: float
) -> None:
    try:
        design = moved(chain, cell, x, y)
    except ValueError:
        fields.pathway[at] = IMPOSSIBLE
        return
    fields.monostable[at] = not design.cells[cell].is_bistable
    try:
        result = cycle(design)
    except StaticsError:
        return
    fields.pathway[at] = _CODES.index(result.pathway or Pathway.OTHER)
    fields.degenerate[at] = bool(result.degenerate)
    for snap in reversed(result.snaps):
        strokes = fields.snap_loading if snap.direction > 0 else fields.snap_unloading
        strokes[at] = snap.stroke


def _labelled(
    fields: _Fields, chain: Chain, cell: int, x: Floats, y: Floats, asked: int
) -> xr.Dataset:
    import xarray as xr

    fixed = chain.cells[1 - cell]
    moving, staying = chain.names[cell], chain.names[1 - cell]
    impossible = int(np.sum(fields.pathway == IMPOSSIBLE))
    unsolved = int(np.sum(fields.pathway == UNSOLVED))
    meanings = [*(p.name.lower() for p in _CODES), "impossible", "unsolved"]
    about = {
        "pathway": {
            "long_name": "order in which the cells load and unload",
            "flag_values": np.array([*range(len(_CODES)), IMPOSSIBLE, UNSOLVED], np.int8),
            "flag_meanings": " ".join(meanings),
        },
        "snap_loading": {"long_name": "stroke of the first snap while loading", "units": "m"},
        "snap_unloading": {"long_name": "stroke of the first snap while unloading", "units": "m"},
        "margin": {
            "long_name": "smaller gap between the cells' F0 and between their F1, over k r",
            "units": "1",
            "k_r_N": fixed.bands[0].stiffness * fixed.lever,
            "k_r_of": staying,
        },
        "monostable": {"long_name": f"{moving} is stable in one state only"},
        "degenerate": {"long_name": "design on a boundary: a tie decides"},
    }
    return xr.Dataset(
        {name: (("y", "x"), getattr(fields, name), notes) for name, notes in about.items()},
        coords={
            "x": ("x", x, {"long_name": f"q_x of {moving}", "units": "m"}),
            "y": ("y", y, {"long_name": f"q_y of {moving}", "units": "m"}),
        },
        attrs={
            "title": chain.title or "transition map",
            "moved_cell": moving,
            "fixed_cell": staying,
            "chain": repr(chain),
            "closed_form_designs": fields.pathway.size - asked,
            "engine_designs": asked - impossible,
            "impossible_designs": impossible,
            "unsolved_designs": unsolved,
            "assumptions": (
                "quasi-static stroke from 00 to 11 and back; overdamped snaps at fixed stroke; "
                "closed form only where both cells are proved taut with falling force and the "
                "actuator is rigid, the general engine elsewhere"
            ),
            "source": f"stepwell {__version__}, transition_map",
        },
    )
