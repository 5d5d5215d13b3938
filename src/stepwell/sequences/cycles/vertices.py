"""Reading the visited vertices off a path."""

from stepwell.sequences.cycles.sequence import Sequence
from stepwell.statics import Path

# Of a cell's travel: what one means who writes 20 mm where the levers give 19.998 mm.
_AT_STOP = 0.01


def arrival(path: Path) -> str:
    """The state in which a path ends, such as "010"; - for a cell between its stops.

    A cell counts as at a stop within a hundredth of its travel.
    """
    travels = zip(path.end.tolist(), path.chain.cells, strict=True)
    parts = (travel / cell.full_travel for travel, cell in travels)
    return "".join("0" if p <= _AT_STOP else "1" if p >= 1 - _AT_STOP else "-" for p in parts)


def sequence_of(path: Path) -> Sequence:
    """Every state with all cells at a stop that the path visits, in order.

    A path that starts between the stops begins with the first vertex it reaches.
    """
    full = [cell.full_travel for cell in path.chain.cells]
    at = [0 if s == 0 else 1 if s == f else -1 for s, f in zip(path.start, full, strict=True)]
    between = sum(a < 0 for a in at)
    vertex = at.copy()
    first: str | None = None if between else "".join(map(str, at))
    flips: list[tuple[int, ...]] = []
    touched: set[int] = set()
    for segment in path.segments():
        for cell, travel in zip(segment.cells, segment.after, strict=True):
            now = 0 if travel == 0 else 1 if travel == full[cell] else -1
            between += (now < 0) - (at[cell] < 0)
            at[cell] = now
            touched.add(cell)
        if between:
            continue
        if first is None:
            first = "".join(map(str, at))
        else:
            flip = tuple(sorted(cell for cell in touched if at[cell] != vertex[cell]))
            if flip:
                flips.append(flip)
        for cell in touched:
            vertex[cell] = at[cell]
        touched.clear()
    if first is None:
        first = "".join("-" if a < 0 else str(a) for a in at)
    return Sequence(first, tuple(flips))
