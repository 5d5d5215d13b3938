"""The transition map: which pathway each place of an anchor gives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import Bbox

from stepwell.figures.common import (
    BLACK,
    COLUMN,
    FAINT,
    INK,
    MM,
    PATHWAY,
    Label,
    beside,
    canvas,
    literal,
    pale,
    styled,
    trim_above,
)
from stepwell.figures.maps.regions import name_regions

if TYPE_CHECKING:
    from xarray import Dataset

    from stepwell.design import Boundary

_IN_TWO_LINES = {"COUNTERCLOCKWISE": "counter-\nclockwise", "OTHER": "other\npathway"}


@styled
def transition_map(
    dataset: Dataset,
    boundaries: Iterable[Boundary] = (),
    designs: Mapping[str, tuple[float, float]] | None = None,
    *,
    ax: Axes | None = None,
) -> Figure:
    """Pathways over the places of one anchor, boundaries as exact curves, designs marked.

    Args:
        dataset: what `design.transition_map` returns, in memory or read back from a file.
        boundaries: what `design.boundaries` returns for the same chain and cell.
        designs: anchor q [m] of each design to be marked, by the name to write beside it.
        ax: axes to draw into; a new figure of one column's width by default.

    Returns:
        The figure: q_x against q_y of the moved cell [mm]; hatched where that cell is stable
        in one state only.

    Source: Kamp et al. 2024, Fig. 2C.
    """
    x, y = dataset["x"].to_numpy() * MM, dataset["y"].to_numpy() * MM
    height = 60.0 * float(np.clip((y[-1] - y[0]) / max(x[-1] - x[0], 1e-9), 0.5, 2.0))
    own = ax is None
    figure, ax = canvas(ax, (COLUMN, height + 28.0), (14.0, 10.0, 3.0, 18.0))
    codes = dataset["pathway"].to_numpy()
    values = np.atleast_1d(dataset["pathway"].attrs["flag_values"])
    names = [name.upper() for name in str(dataset["pathway"].attrs["flag_meanings"]).split()]

    ax.set_facecolor("white")
    shades = ListedColormap([pale(PATHWAY.get(name, "#FFFFFF")) for name in names])
    # A missing pathway stays white.
    place = np.full(codes.shape, np.nan)
    for k, value in enumerate(values):
        if names[k] in PATHWAY:
            place[codes == value] = k
    ax.pcolormesh(
        x,
        y,
        np.ma.masked_invalid(place),
        cmap=shades,
        vmin=-0.5,
        vmax=len(names) - 0.5,
        shading="nearest",
        rasterized=True,
    )
    monostable = dataset["monostable"].to_numpy().astype(float)
    hatched = bool(np.any(monostable)) and min(monostable.shape) > 1
    if hatched:
        ax.contourf(x, y, monostable, [0.5, 1.5], colors="none", hatches=["////"])
        for collection in ax.collections[-1:]:
            collection.set_edgecolor(FAINT)
            collection.set_linewidth(0.0)
    for boundary in boundaries:
        points = np.asarray(boundary.points) * MM
        edge = _is_stability_edge(boundary)
        ax.plot(
            *points.T,
            color=INK,
            linewidth=0.8 if edge else 1.5,
            linestyle=(0, (3, 1.5)) if edge else "-",
            gid="stability edge" if edge else "boundary",
        )
    ax.set_aspect("equal")
    ax.set_xlim(x[0], x[-1])
    ax.set_ylim(y[0], y[-1])
    cell = literal(str(dataset.attrs.get("moved_cell", ""))) or "moved cell"
    ax.set_xlabel(f"$q_x$ of {cell} [mm]")
    ax.set_ylabel(f"$q_y$ of {cell} [mm]")

    free = np.ones(codes.shape, bool)
    for qx, qy in (designs or {}).values():
        # No pathway's name over a design's mark.
        free &= np.hypot(x - qx * MM, (y - qy * MM)[:, None]) > 0.03 * np.ptp(x)
    taken: list[Bbox] = []
    nameless: list[str] = []
    for name, value in zip(names, values, strict=True):
        if name in PATHWAY and np.any(codes == value):
            words = _words(name)
            forms = (words, _IN_TWO_LINES.get(name, words))
            inside = (codes == value) & free
            written = name_regions(ax, x, y, inside, forms, pale(PATHWAY[name]))
            nameless += [] if written else [name]
            taken += written
    marks: list[Label] = []
    for name, (qx, qy) in (designs or {}).items():
        ax.plot(
            qx * MM,
            qy * MM,
            "o",
            markersize=4.6,
            markerfacecolor=BLACK,
            markeredgecolor="white",
            markeredgewidth=0.7,
            zorder=8,
            clip_on=False,
            gid="design",
        )
        marks.append(Label(qx * MM, qy * MM, literal(name)))
    for text in beside(ax, marks, keep_clear=taken):
        text.set_bbox(
            {"boxstyle": "round,pad=0.12", "facecolor": "white", "alpha": 0.8, "linewidth": 0}
        )
    _key(ax, hatched, cell, bool(designs), nameless)
    if own:
        trim_above(ax)
    return figure


def _is_stability_edge(boundary: Boundary) -> bool:
    return boundary.kind.name == "BISTABLE"


def _words(name: str) -> str:
    return "other pathway" if name == "OTHER" else name.lower().replace("_", " ")


def _key(ax: Axes, hatched: bool, cell: str, designs: bool, nameless: list[str]) -> None:
    handles: list[Line2D | Patch] = []
    lines = ax.get_lines()
    if any(line.get_gid() == "boundary" for line in lines):
        handles.append(Line2D([], [], color=INK, linewidth=1.5, label="pathway changes"))
    if designs:
        handles.append(
            Line2D(
                [], [], linestyle="none", marker="o", markersize=4.6, color=BLACK, label="design"
            )
        )
    if hatched:
        handles.append(
            Patch(
                facecolor="white",
                edgecolor=FAINT,
                hatch="//////",
                linewidth=0.0,
                label=f"{cell} monostable",
            )
        )
    if any(line.get_gid() == "stability edge" for line in lines):
        handles.append(
            Line2D(
                [],
                [],
                color=INK,
                linewidth=0.8,
                linestyle=(0, (3, 1.5)),
                label="bistable up to here",
            )
        )
    for name in nameless:
        shade = pale(PATHWAY[name])
        handles.append(Patch(facecolor=shade, linewidth=0.0, label=_words(name)))
    if handles:
        ax.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.02), ncols=2)
