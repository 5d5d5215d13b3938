"""Where a snap lands when one cell, or one pair of cells, moves: exactly.

The landing rule is overdamped flow at fixed drive with equal mobility on every travel. With one
degree of freedom the flow runs along a line, so no time has to be integrated: it stops at the
first place where the driving force vanishes, or at a stop.
"""

import numpy as np

from stepwell.kernels import kernel, overspent
from stepwell.mechanism import Ints, Laws, law
from stepwell.statics.following.pieces import Pieces, find_piece

LANDED, STOPPED, JOINED, UNDECIDED = 0, 1, 2, 3


@kernel
def _ends(
    laws: Laws,
    pieces: Pieces,
    forth: int,
    back: int,
    on_forth: int,
    on_back: int,
    from_forth: float,
    from_back: float,
    force: float,
    softness: float,
    bias: float,
    x: float,
) -> tuple[float, float, float, float]:
    """What pulls (G) and what resists (H) after a shift x, and both slopes by x."""
    if back >= 0:
        value, slope, _ = law(laws, back, pieces.picked[on_back], from_back - x)
        pull, pull_slope = value - laws.friction[back] + bias, -slope
    else:
        pull, pull_slope = force - softness * x + bias, -softness
    if forth >= 0:
        value, slope, _ = law(laws, forth, pieces.picked[on_forth], from_forth + x)
        resist, resist_slope = value + laws.friction[forth], slope
    else:
        resist, resist_slope = force + softness * x, softness
    return pull, pull_slope, resist, resist_slope


@kernel
def slide(
    laws: Laws,
    pieces: Pieces,
    forth: int,
    back: int,
    from_forth: float,
    from_back: float,
    force: float,
    softness: float,
    lowest: float,
    highest: float,
    tolerance: float,
    start: float,
    bias: float,
    effort: Ints,
) -> tuple[int, float, float]:
    """Outcome, shift x and force λ there, for `forth` moving by +x and `back` by -x.

    One of the two may be -1: then the actuator, of stiffness `softness` (0 for a dead load),
    takes its part. `lowest` and `highest` bound the λ at which all other cells keep still; the
    outcome is JOINED where the flow leaves that range. No landing is looked for within `start`,
    a share of the travel; `bias` is a force that helps the motion.
    """
    limit = np.inf
    if forth >= 0:
        limit = min(limit, laws.full[forth] - from_forth)
    if back >= 0:
        limit = min(limit, from_back)
    size = laws.full[forth] if forth >= 0 else laws.full[back]
    near = 1e-12 * size
    start *= size
    on_forth = find_piece(pieces, forth, from_forth, 1) if forth >= 0 else 0
    on_back = find_piece(pieces, back, from_back, -1) if back >= 0 else 0
    paired = forth >= 0 and back >= 0
    lefts = np.empty(256)
    rights = np.empty(256)
    begin = 0.0
    looks = 0
    while True:
        end = limit
        if forth >= 0:
            end = min(end, pieces.right[on_forth] - from_forth)
        if back >= 0:
            end = min(end, from_back - pieces.left[on_back])
        end = max(end, begin)
        lefts[0], rights[0] = begin, end
        waiting = 1 if end > begin else 0
        while waiting > 0:
            looks += 1
            if overspent(effort, 4) or looks > 200_000:
                return UNDECIDED, begin, force
            waiting -= 1
            a, b = lefts[waiting], rights[waiting]
            ga, dga, ha, dha = _ends(
                laws, pieces, forth, back, on_forth, on_back, from_forth, from_back,
                force, softness, bias, a,
            )  # fmt: skip
            gb, dgb, hb, dhb = _ends(
                laws, pieces, forth, back, on_forth, on_back, from_forth, from_back,
                force, softness, bias, b,
            )  # fmt: skip
            one = 0.0
            if paired:
                low = 0.5 * (min(ga, gb) + min(ha, hb))
                high = 0.5 * (max(ga, gb) + max(ha, hb))
                at_b = 0.5 * (gb + hb)
            else:
                one, two = (ga, gb) if back < 0 else (ha, hb)
                low, high, at_b = min(one, two), max(one, two), two
            inside = low >= lowest - tolerance and high <= highest + tolerance
            falls = max(dga, dgb) - min(dha, dhb) <= 0.0
            rises = min(dga, dgb) - max(dha, dhb) >= 0.0
            if inside:
                if b <= start:
                    continue
                if rises and (ga - ha > 0.0 or a <= near):
                    continue
                if falls and gb - hb > 0.0:
                    continue
                if max(ga, gb) - min(ha, hb) <= tolerance and a > start:
                    # Two constant forces in balance: the cells come to rest here.
                    return LANDED, a, (0.5 * (ga + ha) if paired else one)
                if min(ga, gb) - max(ha, hb) > 0.0:
                    continue
            if b - a <= near or 0.5 * (a + b) <= a or 0.5 * (a + b) >= b:
                if gb - hb <= 0.0:
                    share = (ga - ha) - (gb - hb)
                    x = b if share <= 0.0 or ga <= ha else a + (b - a) * (ga - ha) / share
                    g, _, h, _ = _ends(
                        laws, pieces, forth, back, on_forth, on_back, from_forth, from_back,
                        force, softness, bias, x,
                    )  # fmt: skip
                    return LANDED, x, (0.5 * (g + h) if paired else (g if back < 0 else h))
                if at_b < lowest - tolerance or at_b > highest + tolerance:
                    return JOINED, b, at_b
                continue
            middle = 0.5 * (a + b)
            lefts[waiting], rights[waiting] = middle, b
            lefts[waiting + 1], rights[waiting + 1] = a, middle
            waiting += 2
        if end >= limit:
            g, _, h, _ = _ends(
                laws, pieces, forth, back, on_forth, on_back, from_forth, from_back,
                force, softness, bias, limit,
            )  # fmt: skip
            return STOPPED, limit, (0.5 * (g + h) if paired else (g if back < 0 else h))
        if forth >= 0 and pieces.right[on_forth] - from_forth <= end:
            on_forth += 1
        if back >= 0 and from_back - pieces.left[on_back] <= end:
            on_back -= 1
        begin = end
