"""Ranges of the assumed numbers of a robot in which its gait stays, by simulation."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from stepwell import base, files
from stepwell.paper.sensitivity import VARIATIONS, Variation, changed
from stepwell.robot import Robot

# Steps of a number away from its value, over the value, or over a length or force of its unit.
STEPS = (0.25, 1.0, 4.0)
SCALES = {"mm": 10.0, "N": 0.1}
HALVINGS = 3
CYCLES = 2
BANDS = Variation("stiffness of the bands", ("leg.*.chain.cell.*.band.stiffness_N_per_m",), 0, 0)


@dataclass(frozen=True, slots=True, eq=False)
class AssumedRange(base.ByValue):
    """Range of one assumed number in which every leg keeps its gait.

    Attributes:
        label: what it is, with its unit.
        keys: of the design file; a key with a minus sign has the negative value.
        value: of the robot, in the unit of its key.
        low, high: least and largest value tried at which every leg keeps its gait.
        below, above: gaits just outside, "refused" for a robot that cannot walk, "" if the gait
            stayed at every value tried.
    """

    label: str
    keys: tuple[str, ...]
    value: float
    low: float
    high: float
    below: str
    above: str


@dataclass(frozen=True, slots=True, eq=False)
class AssumedRanges(base.ByValue):
    """A robot, the gait of its legs, and the range of each assumed number."""

    robot: Robot
    gaits: tuple[str, ...]
    ranges: tuple[AssumedRange, ...]

    def __repr__(self):
        return f"AssumedRanges({len(self.ranges)} numbers; {_text(self.gaits)})"


def assumed_ranges(
    robot: Robot,
    *,
    cycles: int = CYCLES,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> AssumedRanges:
    """Find, for every assumed number of a robot alone, the range in which its gait stays.

    Each number is multiplied and divided by 1.25, 2 and 5, or moved by 2.5, 10 and 40 mm or 0.025,
    0.1 and 0.4 N for coordinates and frictions of 0, until a leg has another gait; then the
    interval is bisected three times. Values that are refused end the range.

    Args:
        robot: with legs "left" and "right"; parts that were built are left out.
        cycles: of each walk; the last one counts.
        threads: number of parallel runs; all cores by default.
        progress: called with (done, total) rounds.

    Raises:
        ValueError: no cycles, or a robot that the simulator does not support.
        ModuleNotFoundError: MuJoCo is not installed.
    """
    from stepwell.simulation import sweep

    def gaits_of(robots: Sequence[Robot | None]) -> list[str]:
        valid = [one for one in robots if one is not None]
        trials = iter(sweep(valid, cycles=cycles, threads=threads).trials if valid else ())
        texts = ("refused" if one is None else _text(next(trials).gaits) for one in robots)
        return list(texts)

    robot = replace(robot, made=None)
    nominal = sweep([robot], cycles=cycles, threads=threads).trials[0].gaits
    own, rounds = _text(nominal), HALVINGS + 1
    searches = [
        _Search(robot, variation, value, sense)
        for variation, value in assumed(robot)
        for sense in (-1, 1)
    ]
    looks = [[search.at(step) for step in search.steps] for search in searches]
    found = iter(gaits_of([robot for each in looks for robot in each]))
    for search in searches:
        search.take([next(found) for _ in search.steps], own)
    for done in range(HALVINGS):
        base.notify(progress, done + 1, rounds)
        open_ones = [search for search in searches if search.beyond]
        middles = gaits_of([search.at(search.middle) for search in open_ones])
        for search, text in zip(open_ones, middles, strict=True):
            search.halve(text, own)
    base.notify(progress, rounds, rounds)
    ends = zip(searches[::2], searches[1::2], strict=True)
    return AssumedRanges(robot, nominal, tuple(_range(low, high) for low, high in ends))


def assumed(robot: Robot) -> Iterator[tuple[Variation, float]]:
    """The assumed numbers that can matter on a bare floor, and their values in files' units."""
    known = files.parameters(robot)
    for variation in (*VARIATIONS, BANDS):
        path = re.escape(variation.keys[0].lstrip("-")).replace(r"\*", r"[^.\[]+")
        numbers = [one for one in known if re.fullmatch(path, one.path)]
        if numbers and all(one.source == "assumed" for one in numbers):
            yield variation, numbers[0].values[0]


@dataclass
class _Search:
    """The search for one end of a range."""

    robot: Robot
    variation: Variation
    value: float
    sense: int
    good: float = 0.0
    bad: float = math.inf
    beyond: str = ""

    @property
    def steps(self) -> tuple[float, ...]:
        """The steps that are tried; a number that is 0 and cannot be negative has none below."""
        lowest = self.sense < 0 and self.value == 0.0 and "[" not in self.variation.keys[0]
        return () if lowest else STEPS

    def number(self, step: float) -> float:
        """The number at a step away from its value."""
        key = self.variation.keys[0]
        unit = next((unit for unit in SCALES if key.partition("[")[0].endswith(f"_{unit}")), "")
        # Coordinates may have either sign; other numbers stay above 0.
        if unit and ("[" in key or self.value == 0.0):
            return self.value + self.sense * step * SCALES[unit]
        return self.value * (1.0 + step) ** self.sense

    def at(self, step: float) -> Robot | None:
        """The robot at a step, None if it is refused."""
        try:
            return changed(self.robot, self.variation, self.number(step))
        except ValueError:
            return None

    def take(self, texts: Sequence[str], own: str) -> None:
        """The gaits at all steps: the first other gait ends the range."""
        for step, text in zip(self.steps, texts, strict=True):
            if text != own:
                self.bad, self.beyond = step, text
                return
            self.good = step

    @property
    def middle(self) -> float:
        """The step between the last with the gait and the first without."""
        return (self.good + self.bad) / 2

    def halve(self, text: str, own: str) -> None:
        """Take the gait at the middle."""
        if text == own:
            self.good = self.middle
        else:
            self.bad, self.beyond = self.middle, text


def _range(low: _Search, high: _Search) -> AssumedRange:
    ends = (low.number(low.good), high.number(high.good), low.beyond, high.beyond)
    return AssumedRange(low.variation.label, low.variation.keys, low.value, *ends)


def _text(gaits: Sequence[str]) -> str:
    return " | ".join(dict.fromkeys(gait or "none" for gait in gaits))
