"""What a chain does for every place of one of its anchors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stepwell.base import Floats, InputError
from stepwell.design import parameter_boundaries, parameter_map
from stepwell.mechanism import Cell, Chain
from stepwell.studio.wire import Ask, Design, View

_MM = 1e3
_FARTHEST = 1e4  # mm
_MOST_PIXELS = 1000
# Places that the general engine is asked for, a millisecond or so each, before a coarser map does.
_MOST_FOLLOWED = 400


class _TooMany(InputError):
    """The general engine would have to be asked for too many places."""


def answer(design: Design, ask: Ask) -> View:
    """An image of numbers into `sequences`, rows from low to high y; curves where it is fine.

    Every pixel stands for `coarse` by `coarse`, and for more where the closed form does not hold;
    the answer's `coarse` says for how many.
    """
    chain = design.chain
    cell = ask.whole("cell", 0, len(chain) - 1)
    anchor = ask.text("anchor", 1, "q")
    x, y = (ask.pair(key, -_FARTHEST, _FARTHEST) for key in ("x_mm", "y_mm"))
    wide, high = (int(n) for n in ask.numbers("pixels", 2, 2, _MOST_PIXELS, least_many=2))
    wanted = ask.whole("coarse", 1, 64, 1)
    ask.close()
    if anchor not in ("p", "q"):
        raise InputError(f"ask.anchor = {anchor!r}: must be 'p' or 'q'.")
    chain = _one_anchor(chain, cell, anchor)
    coarse = wanted
    while True:
        axes = [
            (f"{cell + 1}.{anchor}.{letter}", _places(ends, n, coarse))
            for letter, ends, n in (("x", x, wide), ("y", y, high))
        ]
        try:
            found = parameter_map(chain, *axes, progress=_few)
            break
        except _TooMany:
            coarse *= 2
    # Curves are exact and cost as much as a map: they come with the fine one.
    curves = parameter_boundaries(chain, *axes) if coarse == wanted == 1 else ()
    attrs = found.sequence.attrs
    meanings = attrs["flag_meanings"].split(" ")
    codes = {int(code): k for k, code in enumerate(attrs["flag_values"])}
    image = np.vectorize(codes.__getitem__, otypes=[np.int32])(found.sequence.values)
    blocks: dict[str, np.ndarray[Any, Any]] = {
        "image": image,
        "x": axes[0][1] * _MM,
        "y": axes[1][1] * _MM,
    }
    told: list[dict[str, Any]] = []
    for k, curve in enumerate(curves):
        blocks[f"boundary {k}"] = curve.points * _MM
        told.append(
            {
                "block": f"boundary {k}",
                "kind": curve.kind.name.lower(),
                "changes": curve.changes,
                "method": curve.method.name.lower(),
                "sequences": list(curve.sequences),
            }
        )
    here = getattr(chain.levers[cell].bands[0], anchor)
    header = {
        "cell": cell,
        "anchor": anchor,
        "coarse": coarse,
        "sequences": meanings,
        "boundaries": told,
        "here_mm": [part * _MM for part in here],
    }
    return View(header, blocks)


def _one_anchor(chain: Chain, number: int, anchor: str) -> Chain:
    """The chain with all bands of a cell at the anchor of its first."""
    one = chain.cells[number]
    if not isinstance(one, Cell):
        raise InputError(f"ask.cell = {number}: is an element, which has no anchors.")
    place = getattr(one.bands[0], anchor)
    bands = tuple(replace(band, **{anchor: place}) for band in one.bands)
    cells = (*chain.cells[:number], replace(one, band=bands), *chain.cells[number + 1 :])
    return replace(chain, cells=cells)


def _places(ends: tuple[float, float], pixels: int, coarse: int) -> Floats:
    """The middle of every pixel [m]."""
    count = max(2, -(-pixels // coarse))
    edges = np.linspace(*ends, count + 1) / _MM
    return (edges[1:] + edges[:-1]) / 2


def _few(_done: float, total: float) -> None:
    if total > _MOST_FOLLOWED:
        raise _TooMany(f"{total:.0f} places have to be followed")
