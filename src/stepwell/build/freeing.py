"""Ways out of collisions: the smallest change of one length of the build file that frees them."""

import math
from collections.abc import Iterator

from stepwell.base import InputError, ReadOnly, bisected
from stepwell.build.bodies import bodies_of
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.layouts import Layout, layout as lay
from stepwell.build.limits import ExceededLimit, findings, setting
from stepwell.build.sweeps import Collision, MotionSweep, compare, sweep

# Lengths that are tried, with the direction in which each frees parts, and their factors at most.
_LENGTHS: dict[str, tuple[float, ...]] = {
    "lever__width": (-1.0,),
    "lever__spacing": (1.0,),
    "lever__clearance": (1.0,),
    "block__edge": (1.0,),
    "block__clearance": (1.0,),
    "hook__clearance": (1.0,),
    "hook__diameter": (-1.0,),
    "hook__cap_width": (-1.0,),
    "band__thickness": (-1.0,),
    "band__width": (-1.0,),
    "screw__head_width": (-1.0,),
    "pin__diameter": (-1.0,),
    "stop__gap": (1.0,),
}
_MOST = 4.0
# The change is rounded up to this step [m].
_STEP = 1e-4
_HALVINGS = 12
# Collisions for which a way out is searched; others are listed.
_MOST_SEARCHED = 4


def collision_findings(layout: Layout, result: MotionSweep) -> tuple[ExceededLimit, ...]:
    """A finding for each collision of a sweep, the first with the change that frees the parts."""
    found: list[ExceededLimit] = []
    # Collisions of like parts have the same way out.
    known: dict[tuple[str, ...], ReadOnly] = {}
    for number, one in enumerate(result.collisions):
        change: ReadOnly = ReadOnly({})
        kinds = tuple(sorted(part.rstrip("ab0123456789-") for part in one.parts))
        if kinds in known:
            change = known[kinds]
        elif number < _MOST_SEARCHED:
            change = known[kinds] = ReadOnly(smallest_change(layout, one, result))
        found.append(_finding(layout, one, change))
    return tuple(found)


def smallest_change(layout: Layout, one: Collision, result: MotionSweep) -> dict[str, float]:
    """The length of the build file with the smallest relative change that frees two parts.

    The change leads to no other collision and breaks no limit. Empty if no single length does.
    """
    ways: list[tuple[float, str, float]] = []
    for name, start, most in _candidates(layout):
        if not _free(layout, one, name, most):
            continue
        value, _ = bisected(
            lambda v, name=name: _free(layout, one, name, v), most, start, _HALVINGS
        )
        value = _rounded(value, away=value > start)
        ways.append((abs(value / start - 1.0), name, value))
    before = {(found.check, found.parts) for found in findings(layout, None)}
    for _, name, value in sorted(ways):
        if _sound(layout, name, value, before, len(result.collisions)):
            return {name: value}
    return {}


def _candidates(layout: Layout) -> Iterator[tuple[str, float, float]]:
    for name, ways in _LENGTHS.items():
        table, _, field = name.partition("__")
        start = getattr(getattr(layout.build_file, table), field)
        for way in ways:
            if start > 0.0:
                yield name, start, start * _MOST if way > 0 else start / _MOST


def _rounded(value: float, *, away: bool) -> float:
    steps = value / _STEP
    return (math.ceil(steps - 1e-6) if away else math.floor(steps + 1e-6)) * _STEP


def _free(layout: Layout, one: Collision, name: str, value: float) -> bool:
    """Whether the two bodies of a collision are apart with another number."""
    changed = _changed(layout, name, value)
    if changed is None:
        return False
    names = [_body_name(part) for part in one.parts]
    bodies = [body for body in bodies_of(changed) if body.name in names]
    if len(bodies) != 2:
        return False
    return all(result.hit is None and not result.undecided for result in compare(changed, *bodies))


def _body_name(piece: str) -> str:
    """The body of a part or a fastener by its name."""
    words = piece.split()
    if "of" in words and words[-2] == "block":
        return f"block {words[-1]}"
    if piece.startswith("block-"):
        return f"block {piece.split('-')[1]}"
    if piece.startswith("foot-"):
        return f"block {piece.split('-')[1]}"
    if piece.startswith("stop-"):
        return f"block {int(piece.split('-')[1]) - 1}"
    return piece


def _changed(layout: Layout, name: str, value: float) -> Layout | None:
    try:
        build_file: BuildFile = layout.build_file.with_lengths(**{name: value})
        return lay(layout.chain, build_file)
    except InputError:
        return None


def _sound(
    layout: Layout, name: str, value: float, before: set[tuple[str, tuple[str, ...]]], count: int
) -> bool:
    """Whether the changed layout has fewer collisions than `count` and no finding not `before`."""
    changed = _changed(layout, name, value)
    if changed is None or not {(f.check, f.parts) for f in findings(changed, None)} <= before:
        return False
    return len(sweep(changed).collisions) < count


def _finding(layout: Layout, one: Collision, change: ReadOnly) -> ExceededLimit:
    where = " and ".join(
        f"travel of cell {cell + 1} from {mm(low)} to {mm(high)} mm"
        for cell, (low, high) in zip(one.cells, one.travels, strict=True)
    )
    states = f", states {', '.join(one.states)} included" if one.states else ""
    advice = "No single length of the build file frees them: use another lever, limit or anchor."
    if change:
        name, value = next(iter(change.items()))
        advice = (
            f"Set {setting(layout, name, value, 'mm')}; it is the smallest change that frees them."
        )
    return ExceededLimit(
        "collision",
        one.parts,
        one.overlap,
        0.0,
        "m",
        f"{one.parts[0]} and {one.parts[1]} overlap by {mm(one.overlap)} mm at {where} (stroke "
        f"{mm(one.stroke[0])} to {mm(one.stroke[1])} mm{states}).",
        advice,
        change,
    )
