"""The solid parts of a build, layer by layer, at one state or at any angles of its levers."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch
from matplotlib.path import Path

from stepwell.base import Floats, InputError, Vec2
from stepwell.build import Build, Collision, Contour, Fastener, Layout, Part
from stepwell.figures.common import legends, marks, sheet, style

# Chords of drawn arcs are at most this far off [m].
_SAGITTA = 2e-5
# Around the parts of a panel, above it for its name, and below all for the key [mm].
_EDGE, _ABOVE, _BELOW = 1.5, 6.0, 7.0
_GAP = 3.0
_OVERLAP = "#B00020"


@style.styled
def layers(build: Build, state: str | Sequence[float] | None = None) -> Figure:
    """The parts of a build in plan, a panel for each layer and one for hooks and bands.

    Blocks are grey, the fixed one darker; levers and bands have the colour of their cell. Parts
    that overlap at these angles are red.

    Args:
        build: the build.
        state: a state such as "01", or the angles of all cells [rad]; by default all cells at 0,
            or the deepest overlap of a build that has one.

    Raises:
        ValueError: a state or angles that this chain cannot have.
    """
    layout, collisions = build.layout, build.sweep.collisions
    if state is None:
        angles = list(collisions[0].angles) if collisions else layout.angles("0" * len(build.chain))
    else:
        angles = layout.angles(state) if isinstance(state, str) else _checked(layout, state)
    drawing = _Drawing(layout, angles, _overlapping(collisions, angles))
    width = sheet.page_width(style.PAGE)
    columns = 2 if width >= sheet.SIDE_BY_SIDE else 1
    wide = (width - _GAP * (columns - 1)) / columns
    left, bottom, right, top = drawing.box
    tall = (wide - 2.0 * _EDGE) * (top - bottom) / (right - left) + 2.0 * _EDGE
    names = drawing.panels
    rows = -(-len(names) // columns)
    key_rows, below = (1, _BELOW) if columns == 2 else (2, 1.6 * _BELOW)
    figure = sheet.blank(width, rows * (tall + _ABOVE) + below)
    places = sheet.grid(len(names), columns, (wide + _GAP, tall + _ABOVE), (0.0, below))
    for (x, y), (layer, name) in zip(places, names, strict=True):
        ax = sheet.place(figure, x, y, wide, tall)
        drawing.draw(ax, layer)
        pad = _EDGE * (right - left) / (wide - 2.0 * _EDGE)
        marks.plain(ax, (left - pad, right + pad, bottom - pad, top + pad))
        sheet.name_panel(ax, name if build.can_be_built else f"DRAFT: {name}", 0.8)
    key = legends.applicable(
        (True, legends.shade("fixed block", style.FIXED_BLOCK)),
        (True, legends.shade("block", style.BLOCK)),
        (True, legends.shade("lever", style.pale(style.GREEN, 0.3))),
        (True, legends.shade("drive bar", style.pale(style.BLUE, 0.5))),
        (True, legends.mark("pin, hook or screw", **style.hollow(3.5))),
        (bool(drawing.overlapping), legends.shade("overlap", _OVERLAP)),
    )
    legends.below(figure, key, -(-len(key) // key_rows), left=2.0, handlelength=1.0)
    return figure


def _checked(layout: Layout, angles: Sequence[float]) -> list[float]:
    limits = [one.cell.limit for one in layout.cells]
    given = [float(one) for one in angles]
    if len(given) != len(limits) or any(
        abs(a) > limit * (1.0 + 1e-9) for a, limit in zip(given, limits, strict=False)
    ):
        raise InputError(
            f"angles = {given}: must be {len(limits)} angles [rad] between the stops, "
            f"±{limits} rad."
        )
    return given


def _overlapping(collisions: Iterable[Collision], angles: Sequence[float]) -> set[str]:
    """Names of parts that overlap at these angles, as far as the sweep recorded the angles."""
    names: set[str] = set()
    for one in collisions:
        if np.allclose([one.angles[i] for i in one.cells], [angles[i] for i in one.cells]):
            names |= set(one.parts)
    return names


class _Drawing:
    """The shapes of all parts in plan [mm] at some angles."""

    def __init__(self, layout: Layout, angles: Sequence[float], overlapping: set[str]):
        self.layout, self.overlapping = layout, overlapping
        self.frames = layout.frames(angles)
        self.at = layout.positions(angles)
        self.colours = style.cell_colours(len(layout.cells))
        every = np.concatenate([self._placed(part, part.outline) for part in layout.parts])
        low, high = every.min(axis=0), every.max(axis=0)
        self.box = float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @property
    def panels(self) -> list[tuple[int | None, str]]:
        """Number and name of each layer from below; None for hooks and bands."""
        bases = sorted({(part.layer, part.base) for part in self.layout.parts})
        thick = self.layout.stack.thickness
        named: list[tuple[int | None, str]] = [
            (layer, f"Layer {layer}: z = {marks.mm(base)} to {marks.mm(base + thick)} mm")
            for layer, base in bases
        ]
        return [*named, (None, "Hooks and bands")]

    def _placed(self, part: Part, contour: Contour) -> Floats:
        x, y, angle = self.frames[part.name]
        c, s = np.cos(angle), np.sin(angle)
        turned = contour.ring(_SAGITTA) @ np.array([[c, s], [-s, c]])
        return (turned + np.array([x, y])) * style.MM

    def _colour(self, part: Part) -> style.Colour:
        if part.name in self.overlapping:
            return _OVERLAP
        kind, *number = self.layout.body[part.name]
        if kind == "block":
            return style.BLOCK if number[0] else style.FIXED_BLOCK
        if kind == "lever":
            return style.pale(self.colours[int(number[0])], 0.3)
        return style.pale(style.BLUE, 0.5)

    def draw(self, ax: Axes, layer: int | None) -> None:
        """Draw one layer, or hooks and bands over the outlines of the highest layer."""
        highest = max(part.layer for part in self.layout.parts)
        for part in self.layout.parts:
            if part.layer == (highest if layer is None else layer):
                self._part(ax, part, plain=layer is None)
        for one in self.layout.fasteners:
            if one.use in ("hook", "nut") if layer is None else self._stands_in(one, layer):
                self._fastener(ax, int(one.block), one.centre, one.diameter)
        if layer is None:
            self._bands(ax)

    def _stands_in(self, one: Fastener, layer: int) -> bool:
        low = next(part.base for part in self.layout.parts if part.layer == layer)
        high = low + self.layout.stack.thickness
        return one.use != "shim" and one.low < high - 1e-6 and one.high > low + 1e-6

    def _part(self, ax: Axes, part: Part, *, plain: bool) -> None:
        # Openings run the other way round, so that they stay empty.
        rings = [
            self._placed(part, part.outline),
            *(self._placed(part, one)[::-1] for one in part.openings),
        ]
        vertices = np.concatenate([np.vstack([ring, ring[:1]]) for ring in rings])
        codes = np.concatenate(
            [[Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY] for ring in rings]
        )
        colour = style.pale(style.BLOCK, 0.6) if plain else self._colour(part)
        look = {"edgecolor": style.FAINT if plain else style.INK, "linewidth": 0.4}
        ax.add_patch(PathPatch(Path(vertices, codes), facecolor=colour, **look))

    def _fastener(self, ax: Axes, block: int, centre: Vec2, diameter: float) -> None:
        x, y = (self.at[block] + centre) * style.MM
        look = {"facecolor": "white", "edgecolor": style.INK, "linewidth": 0.5, "zorder": 3}
        ax.add_patch(Circle((float(x), float(y)), diameter * style.MM / 2.0, **look))

    def _bands(self, ax: Axes) -> None:
        for path in self.layout.bands:
            ends = self.at[path.cell : path.cell + 2] + np.array([path.p, path.q])
            ax.plot(*(ends * style.MM).T, color=self.colours[path.cell], lw=2.0, zorder=4)
            for (x, y), hole in zip(ends * style.MM, path.holes, strict=True):
                ax.annotate(
                    hole,
                    (x, y),
                    (4.0, 3.0),
                    textcoords="offset points",
                    fontsize=6.0,
                    zorder=5,
                    bbox=style.on_white(0.05, 0.7),
                )
