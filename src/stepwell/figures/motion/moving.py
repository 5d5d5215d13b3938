"""The moving mechanism as one small, self-playing SVG."""

import os
from collections.abc import Iterable, Sequence
from dataclasses import fields
from html import escape
from pathlib import Path as File

import numpy as np

from stepwell.base import Floats, InputError, printable, write_atomic
from stepwell.figures.cells.linkage import SLACK_DASHES, THICKEST, THINNEST
from stepwell.figures.cells.mechanism import refuse_long
from stepwell.figures.common import reading, style
from stepwell.figures.motion.stroke_program import instants
from stepwell.mechanism import layout
from stepwell.sequences import Cycle, Program
from stepwell.statics import Path

# Invisible difference [px].
_UNSEEN = 0.35


class MotionRound:
    """One round of a motion of this duration [s], repeated for ever."""

    def __init__(self, seconds: float):
        self._often = f'dur="{seconds:g}s" repeatCount="indefinite"'

    def path(self, values: Floats, shape: str, look: str, changes: str = "") -> str:
        """A path whose points move; `values` (frames, numbers) [px] fill the {} of its commands
        `shape`; `look` are its attributes, `changes` animations of further attributes.
        """
        if not values.shape[1]:
            return ""
        steps = [shape.format(*map(short, row)) for row in values]
        moved = self._animation("animate", 'attributeName="d"', steps, _key_frames(values))
        return f'<path {look} d="{steps[0]}">{moved}{changes}</path>'

    def width(self, widths: Floats) -> str:
        """The change of a line's width (frames,) [px]."""
        steps = [short(one, 2) for one in widths]
        return self._animation(
            "animate", 'attributeName="stroke-width"', steps, _key_frames(widths[:, None])
        )

    def dashes(self, pattern: str, when: list[bool]) -> str:
        """The change of a line, dashed in the frames `when` and solid in all others."""
        how = 'attributeName="stroke-dasharray" calcMode="discrete"'
        texts = [pattern if one else "none" for one in when]
        return self._animation("animate", how, texts, _changes(when))

    def shifted(self, points: Floats, shift: Floats, look: str) -> str:
        """A line (n, 2) of fixed shape that shifts by (frames, 2) [px]."""
        steps = "L".join(f"{short(x)} {short(y)}" for x, y in points)
        offsets = [f"{short(x)} {short(y)}" for x, y in shift]
        how = 'attributeName="transform" type="translate"'
        moved = self._animation("animateTransform", how, offsets, _key_frames(shift))
        return f'<path {look} d="M{steps}">{moved}</path>'

    def seen(self, inside: str, when: list[bool]) -> str:
        """An element that is visible only in the frames `when`; "" if in none."""
        if not any(when):
            return ""
        values = [str(int(one)) for one in when]
        how = 'attributeName="opacity" calcMode="discrete"'
        leaps = self._animation("animate", how, values, _changes(when))
        return f'<g opacity="{values[0]}">{leaps}{inside}</g>'

    def _animation(self, element: str, how: str, texts: list[str], keep: list[int]) -> str:
        words = [texts[k] for k in keep]
        if len(set(words)) == 1:
            return ""
        last = len(texts) - 1
        times = ";".join(short(k / last, 4) for k in keep)
        return f'<{element} {how} {self._often} keyTimes="{times}" values="{";".join(words)}"/>'


def short(value: float, digits: int = 1) -> str:
    """A number with at most `digits` decimals, without trailing zeros."""
    text = f"{value + 0.0:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


def _changes(when: list[bool]) -> list[int]:
    """Frames at which the value changes, and the first one."""
    return [k for k, one in enumerate(when) if not k or one != when[k - 1]]


def _key_frames(values: Floats) -> list[int]:
    """Frames between which linear interpolation is exact, except for invisible differences."""
    keep, last = [0], len(values) - 1
    while (first := keep[-1]) < last:
        bent = (end for end in range(first + 1, last) if _bent(values[first : end + 2]))
        keep.append(next(bent, last))
    return keep


def _bent(values: Floats) -> bool:
    share = np.linspace(0.0, 1.0, len(values))[:, None]
    straight = values[0] + share * (values[-1] - values[0])
    return bool(np.abs(values - straight).max() > _UNSEEN)


# Frames per second; the viewer interpolates linearly between two frames.
_RATE = 12.5
# Width of the picture, margin around the drawing, height of the text above it [px].
_WIDE, _ROOM, _ABOVE = 480.0, 14.0, 26.0
_FONT = 'font-family="sans-serif" font-weight="bold"'
_SNAP = (
    f'<rect x="{_WIDE - 62:g}" y="6" width="52" height="20" rx="4" fill="{style.YELLOW}"/>'
    f'<text x="{_WIDE - 36:g}" y="20.5" text-anchor="middle" {_FONT} font-size="14">snap</text>'
)


def moving(
    result: Cycle | Path | Program, file: str | os.PathLike[str], *, seconds: float = 8.0
) -> File:
    """Write the moving mechanism as an SVG that repeats for ever, for web pages.

    The SVG has no script, so it also plays as an image, and is small: about 50 kB for two cells,
    100 kB for six. The timing is that of `animation`; a motion that does not return to its start
    restarts there.

    Args:
        result: a cycle, a path or a stroke program, of up to 12 cells.
        file: path of the file, returned; written completely or not at all.
        seconds: duration of one round.

    Raises:
        ValueError: a chain too long to draw, a duration <= 0 or above 60 s, or a file name that
            does not end in .svg.
    """
    path = reading.path_of(result)
    refuse_long(path.chain)
    if not 0 < seconds <= 60:
        raise InputError(f"seconds = {seconds}: must be > 0 and at most 60.")
    if File(file).suffix.lower() != ".svg":
        raise InputError(f"{file}: a moving picture's name must end in .svg.")
    write_atomic(File(file), _Picture(path, seconds).text)
    return File(file)


class _Picture:
    """The drawing of `Drawing` as moving SVG parts."""

    def __init__(self, path: Path, seconds: float):
        self.chain = path.chain
        self.colours = style.cell_colours(len(self.chain))
        ends = [path.travel.min(axis=0), path.travel.max(axis=0)]
        self.linkage = layout.ChainLayout(self.chain, ends)
        frames = instants(path, seconds, max(2, round(seconds * _RATE)))
        # A cycle ends where it begins; a program rests at its end before it restarts.
        around = np.allclose(path.travel[0], path.travel[-1], atol=1e-9)
        frames.append(frames[0] if around else frames[-1])
        poses = [self.linkage.pose(frame.travels, frame.sheets) for frame in frames]
        # Position of every part in each frame.
        self.parts = layout.Pose(
            *(
                np.array([getattr(pose, part.name) for pose in poses])
                for part in fields(layout.Pose)
            )
        )
        self.snaps = [frame.snap for frame in frames]
        self.round = MotionRound(seconds)
        self.left, self.bottom, right, top = self.linkage.bounds([f.travels for f in frames])
        self.left = min(self.left, -1.8 * self.linkage.reach)
        self.scale = (_WIDE - 2 * _ROOM) / (right - self.left)
        self.high = (top - self.bottom) * self.scale + 2 * _ROOM + _ABOVE
        self.weight = float(np.clip(self.scale * self.linkage.reach / 12.0, 0.5, 2.0))

    @property
    def text(self) -> str:
        title = _plain(self.chain.title) or "A mechanism in motion"
        drawn = (*self._linkage(), *self._bands(), *self._symbols())
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDE:g} {self.high:.0f}" '
            f'role="img" aria-label="{title}"><title>{title}</title>'
            f'<rect width="100%" height="100%" rx="8" fill="white"/>{"".join(drawn)}'
            f"{self._names(self.chain.names)}{self.round.seen(_SNAP, self.snaps)}</svg>\n"
        )

    def _linkage(self) -> Iterable[str]:
        yield _mark("joint", "white", style.INK, 1.8 * self.weight) + self._ground()
        yield self._lines(self.parts.posts, style.FIXED_BLOCK, 2.6)
        yield self._lines(self.parts.rods, style.INK, 2.0)
        yield self._boxes(self.parts.blocks[:, :1], style.FIXED_BLOCK)
        yield self._boxes(self.parts.blocks[:, 1:], style.BLOCK)
        yield self._lines(self.parts.levers, style.INK, 2.0, "joint")

    def _bands(self) -> Iterable[str]:
        for i in dict.fromkeys(self.linkage.owner.tolist()):
            yield _mark(f"anchor{i}", self.colours[i], "none", 2.6 * self.weight)
        strongest = self.linkage.greatest_tension() or 1.0
        for b, i in enumerate(self.linkage.owner.tolist()):
            share = np.abs(self.parts.tension[:, b]) / strongest
            widths, slack = (
                THINNEST + (THICKEST - THINNEST) * share,
                self.parts.slack[:, b].tolist(),
            )
            pattern = " ".join(short(one * self.weight * THINNEST, 2) for one in SLACK_DASHES[1])
            changes = self.round.width(self.weight * widths) + self.round.dashes(pattern, slack)
            look = self._pen(self.colours[i], widths[0]) + _ends(f"anchor{i}")
            look += f' stroke-dasharray="{pattern}"' * slack[0]
            ends = self._page(self.parts.bands[:, b]).reshape(len(slack), -1)
            yield self.round.path(ends, _LINE, look, changes)

    def _symbols(self) -> Iterable[str]:
        for m, (i, symbol) in enumerate(self.linkage.symbols.items()):
            yield self._boxes(self.parts.boxes[:, m : m + 1], "white")
            at = self._page(self.parts.boxes[:, m, :2])
            look = f'fill="none" {self._pen(self.colours[i], 2.0)}'
            side = self.linkage.box * self.scale
            for curve in symbol.curves:
                few = curve[:: max(1, len(curve) // 48)]
                yield self.round.shifted(at[0] + few * (side, -side), at - at[0], look)
            for colour, width in (("white", 8.0), (style.INK, 6.0)):
                at = self._page(self.parts.dots[:, m])
                yield self.round.path(at, "M{} {}h0", self._pen(colour, width))

    def _lines(self, lines: Floats, colour: str, width: float, mark: str = "") -> str:
        ends = self._page(lines).reshape(len(lines), -1)
        look = f'fill="none" {self._pen(colour, width)}'
        look += _ends(mark) if mark else ""
        return self.round.path(ends, _LINE * (ends.shape[1] // 4), look)

    def _boxes(self, boxes: Floats, fill: str) -> str:
        page = self._page(layout.corners(boxes.reshape(-1, 4))).reshape(len(boxes), -1)
        shape = "M{} {}L{} {}L{} {}L{} {}Z" * boxes.shape[1]
        return self.round.path(page, shape, f'fill="{fill}" {self._pen(style.INK, 0.8)}')

    def _ground(self) -> str:
        page = self._page(self.linkage.wall).reshape(-1, 4)
        drawn = "".join("M{} {}L{} {}".format(*map(short, stroke)) for stroke in page)
        return f'<path d="{drawn}" fill="none" {self._pen(style.INK, 0.9)}/>'

    def _names(self, names: Sequence[str]) -> str:
        spans = "".join(
            f'<tspan fill="{colour}" dx="{10 if k else 0}">{_plain(name)}</tspan>'
            for k, (name, colour) in enumerate(zip(names, self.colours, strict=True))
        )
        # A letter is about 0.6 of its size wide; the word "snap" needs room at the right.
        letters = sum(len(name) for name in names) + 1.5 * len(self.chain)
        size = min(13.0, (_WIDE - 90) / (0.6 * letters))
        return f'<text x="{_ROOM:g}" y="20" {_FONT} font-size="{short(size)}">{spans}</text>'

    def _pen(self, colour: str, width: float) -> str:
        thick = short(width * self.weight, 2)
        return f'stroke="{colour}" stroke-width="{thick}" stroke-linecap="round"'

    def _page(self, points: Floats | list[list[tuple[float, float]]]) -> Floats:
        """Points [m] on the picture [px], y down."""
        x, y = np.moveaxis(np.asarray(points, float), -1, 0)
        across = _ROOM + (x - self.left) * self.scale
        return np.stack([across, self.high - _ROOM - (y - self.bottom) * self.scale], axis=-1)


# A straight line between two points.
_LINE = "M{} {}L{} {}"


def _ends(mark: str) -> str:
    """Attributes of a line with a marker at its ends."""
    return "".join(f' marker-{at}="url(#{mark})"' for at in ("start", "mid", "end"))


def _mark(name: str, fill: str, stroke: str, radius: float) -> str:
    """A circular SVG marker for the ends of lines."""
    size = short(2 * radius + 2)
    return (
        f'<marker id="{name}" markerUnits="userSpaceOnUse" overflow="visible" '
        f'markerWidth="{size}" markerHeight="{size}">'
        f'<circle r="{short(radius)}" fill="{fill}" stroke="{stroke}"/></marker>'
    )


def _plain(text: str) -> str:
    # Only characters that XML allows.
    return escape(printable(text))
