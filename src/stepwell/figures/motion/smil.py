"""Parts of an SVG that move over and over, each told by as few instants as do."""

from __future__ import annotations

import numpy as np

from stepwell.base import Floats

# What cannot be seen [px].
_UNSEEN = 0.35


class Round:
    """One round of a motion, which begins again where it ends.

    Args:
        seconds: how long it lasts.
    """

    def __init__(self, seconds: float):
        self._often = f'dur="{seconds:g}s" repeatCount="indefinite"'

    def path(self, values: Floats, shape: str, look: str) -> str:
        """A path whose points move.

        Args:
            values: (frames, numbers) what `shape` takes [px].
            shape: its commands, with {} for each number.
            look: its attributes.
        """
        if not values.shape[1]:
            return ""
        told = [shape.format(*map(short, row)) for row in values]
        moved = self._told("animate", 'attributeName="d"', told, _kept(values))
        return f'<path {look} d="{told[0]}">{moved}</path>'

    def shifted(self, points: Floats, shift: Floats, look: str) -> str:
        """A line that keeps its shape.

        Args:
            points: (n, 2) of it in the first frame [px].
            shift: (frames, 2) how far it has gone from there [px].
            look: its attributes.
        """
        steps = "L".join(f"{short(x)} {short(y)}" for x, y in points)
        told = [f"{short(x)} {short(y)}" for x, y in shift]
        how = 'attributeName="transform" type="translate"'
        moved = self._told("animateTransform", how, told, _kept(shift))
        return f'<path {look} d="M{steps}">{moved}</path>'

    def seen(self, inside: str, when: list[bool]) -> str:
        """What is there in some frames alone; nothing where it is in none."""
        if not any(when):
            return ""
        told = [str(int(one)) for one in when]
        keep = [k for k, one in enumerate(when) if not k or one != when[k - 1]]
        how = 'attributeName="opacity" calcMode="discrete"'
        leaps = self._told("animate", how, told, keep)
        return f'<g opacity="{told[0]}">{leaps}{inside}</g>'

    def _told(self, element: str, how: str, told: list[str], keep: list[int]) -> str:
        words = [told[k] for k in keep]
        if len(set(words)) == 1:
            return ""
        last = len(told) - 1
        times = ";".join(short(k / last, 4) for k in keep)
        return f'<{element} {how} {self._often} keyTimes="{times}" values="{";".join(words)}"/>'


def short(value: float, digits: int = 1) -> str:
    """A number without what nobody sees."""
    text = f"{value + 0.0:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


def _kept(values: Floats) -> list[int]:
    """The frames between which all goes straight, but for what cannot be seen."""
    keep, last = [0], len(values) - 1
    while keep[-1] < last:
        first = keep[-1]
        end = first + 1
        while end < last and not _bent(values[first : end + 2]):
            end += 1
        keep.append(end)
    return keep


def _bent(values: Floats) -> bool:
    share = np.linspace(0.0, 1.0, len(values))[:, None]
    straight = values[0] + share * (values[-1] - values[0])
    return bool(np.abs(values - straight).max() > _UNSEEN)
