"""Four and six legs on one actuator: feet lift and land in a wave, hind legs first."""

import numpy as np

import stepwell as sw

LIFTED = 0.001  # a foot that is higher than this above the floor [m] is in the air


def contacts(walk: sw.simulation.Walk) -> dict[str, tuple[float, float]]:
    """For each leg the fractions of the last cycle at which its foot lifts and lands."""
    begin, end = walk.starts[-2:]
    inside = (walk.time >= begin) & (walk.time <= end)
    phase = (walk.time[inside] - begin) / (end - begin)
    found = {}
    for i, leg in enumerate(walk.robot.legs):
        up = walk.foot_height[inside, i] > LIFTED
        lifts, lands = phase[1:][up[1:] & ~up[:-1]], phase[1:][~up[1:] & up[:-1]]
        found[leg.name] = round(float(lifts[0]), 2), round(float(lands[-1]), 2)
    return found


walks = {count: sw.preset(f"robot-{count}-legs").walk(3) for count in ("six", "four")}
for count, walk in walks.items():
    advance, turn = float(walk.advance[-1]), float(np.degrees(walk.turn[-1]))
    print(f"{count} legs: d/u_max {advance:.2f}, turn {turn:z.1f}° per cycle")
    for name, (lifts, lands) in contacts(walk).items():
        print(
            f"  {name} lifts at {lifts} and lands at {lands} of the cycle; {walk.gaits[name][-1]}"
        )

left = {name: phases for name, phases in contacts(walks["six"]).items() if name.startswith("left")}
wave = [lifts for lifts, _ in left.values()]
print(f"wave of lifts from the hind legs to the front legs: {wave}")
print(f"wave of landings: {[lands for _, lands in left.values()]}")
