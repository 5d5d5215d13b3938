"""What a file's name says of the test: a configuration, a baseline, a band, a number."""

from __future__ import annotations

import re
from dataclasses import dataclass

from stepwell.base import Vec2

_RUN = re.compile(r"^(?P<stem>.*?)_?(?P<run>\d+)$")
_UNIT = re.compile(r"^(?P<cells>[12])unit_(?P<code>[BMTLR]+)(?P<mark>(?:_[A-Za-z]\w*)?)$")
_SAMPLE = re.compile(r"^samp(?:le)?_?(?P<sample>\d+)(?!\d)", re.IGNORECASE)
_BASELINE = re.compile(r"friction|baseline|no_?band", re.IGNORECASE)

_P = {"M": (-0.010, 0.0), "T": (0.0, 0.0)}
_QX = {"B": 0.0, "M": 0.010, "T": 0.020}
_QY = {"L": 0.015, "M": 0.0, "R": -0.015}
# Every q that a name can say [m].
PLACES: tuple[Vec2, ...] = tuple((x, y) for x in _QX.values() for y in _QY.values())


@dataclass(frozen=True)
class Setup:
    """A configuration that a name encodes.

    Attributes:
        code: the letters, with the marks behind them.
        anchors: for each cell, inner first, its p and q [m].
        marked: what the name adds, such as "bad"; empty for nothing.
    """

    code: str
    anchors: tuple[tuple[Vec2, Vec2], ...]
    marked: str


def stem_of(name: str) -> str:
    """A name without its run number."""
    found = _RUN.match(name)
    return found["stem"] if found else name


def run_number(name: str) -> int | None:
    """The number at the end of a name, if there is one."""
    found = _RUN.match(name)
    return int(found["run"][:18]) if found else None


def is_baseline(name: str) -> bool:
    """Whether a name says that no band was on: friction, baseline, no_band."""
    return _BASELINE.search(name) is not None


def sample_number(name: str) -> int | None:
    """The sample in a name such as Samp2_45mm_7."""
    found = _SAMPLE.match(name)
    return int(found["sample"][:18]) if found else None


def setup_of(name: str) -> Setup | None:
    """The configuration in a name such as 1unit_MLT_3 or 2unit_TMTBM_5; None where there is none.

    The first letter of a cell is its p: M for (-10, 0) mm, T for (0, 0). The others are its q:
    x of B, M, T is 0, 10, 20 mm, y of L, M, R is 15, 0, -15 mm, what is not said is x = 10, y = 0.
    In a pair the inner cell has two letters; the outer one repeats p or, being one letter, takes it
    over.

    Source: file names of the recordings published with Kamp et al. 2024.
    """
    found = _UNIT.match(stem_of(name))
    if found is None:
        return None
    code = found["code"]
    parts = [code] if found["cells"] == "1" else [code[:2], code[2:]]
    if found["cells"] == "2" and not (len(parts[1]) > 1 and parts[1][0] in _P):
        parts[1] = code[0] + parts[1]
    anchors = tuple(pair for part in parts if (pair := _anchors(part)) is not None)
    if len(anchors) < len(parts):
        return None
    return Setup(code + found["mark"], anchors, found["mark"].strip("_"))


def _anchors(letters: str) -> tuple[Vec2, Vec2] | None:
    """p and q of one cell; None for letters that do not say one thing each."""
    p, rest = _P.get(letters[:1]), letters[1:]
    if p is None or not 1 <= len(rest) <= 2:
        return None
    # M is the middle of x where it stands alone or beside L or R, of y beside B or T.
    x: float | None = None
    y: float | None = None
    for letter in sorted(rest, key="BTLRM".index):
        if letter in _QX and x is None:
            x = _QX[letter]
        elif letter in _QY and y is None:
            y = _QY[letter]
        else:
            return None
    return p, (0.010 if x is None else x, 0.0 if y is None else y)
