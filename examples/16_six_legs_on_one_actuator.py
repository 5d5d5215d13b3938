"""Four and six legs on one actuator: feet lift in a wave, hind legs first, and land together."""

import math

import numpy as np

import stepwell as sw
from stepwell.robot import Body, Leg, Robot

STROKE, SPACING, HALF_WIDTH = 0.040, 0.140, 0.0575
LIFTED = 0.001  # a foot that is higher than this above the floor [m] is in the air


def cell(name: str, travel: float, q: float, stiffness: float) -> sw.Cell:
    """A cell with the paper's band lengths and this full travel [m]."""
    lever = max(0.010 * math.sqrt(2), travel / math.sqrt(2))
    limit = math.asin(travel / 2 / lever)
    band = sw.Band((-0.010, 0.0), (q, 0.0), stiffness, 0.010)
    return sw.Cell(band, lever=lever, limit=limit, name=name)


# For each pair of legs, hind legs first: full travel of the inner cell [m], anchor q_x [m] and
# stiffness [N/m] of the inner cell, and of the outer cell. The outer cells, which lift the feet,
# have the rest of the stroke; in each leg the inner cell needs less force than the outer one.
SIX = [
    (0.012, (0.012, 60.0), (0.020, 30.0)),
    (0.020, (0.010, 30.0), (0.020, 30.0)),
    (0.028, (0.009, 30.0), (0.020, 60.0)),
]
FOUR = [(0.014, (0.008, 60.0), (0.022, 30.0)), (0.026, (0.009, 30.0), (0.020, 60.0))]


def machine(pairs: list[tuple[float, tuple[float, float], tuple[float, float]]]) -> Robot:
    """A robot with two legs for each entry, in two rows."""
    middle = (len(pairs) - 1) / 2
    legs = [
        Leg(
            f"{row} {i + 1}",
            sw.Chain([cell("inner", travel, *inner), cell("outer", STROKE - travel, *outer)]),
            ((i - middle) * SPACING, side * HALF_WIDTH),
        )
        for i, (travel, inner, outer) in enumerate(pairs)
        for row, side in (("left", 1), ("right", -1))
    ]
    end = middle * SPACING
    supports = ((-end - 0.060, 0.0), (end + 0.040, 0.045), (end + 0.040, -0.045))
    body = Body(length=2 * end + 0.120, supports=supports, centre=(0.0, 0.0, 0.0))
    return Robot(legs, body=body, title=f"{2 * len(pairs)} legs on one actuator")


def lifts(walk: sw.simulation.Walk) -> dict[str, list[float]]:
    """For each leg the fractions of the last cycle at which its foot leaves the floor."""
    begin, end = walk.starts[-2:]
    inside = (walk.time >= begin) & (walk.time <= end)
    phase = (walk.time[inside] - begin) / (end - begin)
    found = {}
    for i, leg in enumerate(walk.robot.legs):
        up = walk.foot_height[inside, i] > LIFTED
        found[leg.name] = phase[1:][up[1:] & ~up[:-1]].round(2).tolist()
    return found


walks = {len(pairs) * 2: machine(pairs).walk(3) for pairs in (SIX, FOUR)}
for count, walk in walks.items():
    advance, turn = float(walk.advance[-1]), float(np.degrees(walk.turn[-1]))
    print(f"{count} legs: d/u_max {advance:.2f}, turn {turn:.1f}° per cycle")
    for name, phases in lifts(walk).items():
        print(f"  {name} lifts at {phases} of the cycle; {walk.gaits[name][-1]}")

wave = [phase for name, (phase,) in lifts(walks[6]).items() if name.startswith("left")]
print(f"wave of lifts from the hind legs to the front legs: {wave}")
