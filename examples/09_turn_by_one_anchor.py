"""One anchor moved in the middle of a run turns the robot; moved back, it walks straight on."""

import numpy as np

import stepwell as sw

forward = sw.preset("robot-forward")
turning = forward.with_anchors("left", "outer", q=(0.005, 0.0))

# Each part goes on from where the one before it ended, in the middle of its motion.
straight = forward.walk(4)
around = turning.walk(6, start=straight)
on = forward.walk(4, start=around)

for walk in (straight, around, on):
    turned = round(np.degrees(walk.turn.sum()), 1) + 0.0
    print(f"{walk.cycles} cycles: left {walk.gaits['left'][-1]}, turns by {turned}° to the left")

turn_deg = float(np.degrees(around.turn.mean()))
print(f"that is {turn_deg:.1f}° a cycle while the anchor was moved")
