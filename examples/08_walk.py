"""A robot walks: one position command goes out and back, and the gait comes out of the springs."""

import stepwell as sw

robot = sw.preset("robot-forward")
predicted = robot.predict()  # statics alone
walk = robot.walk(cycles=8)  # MuJoCo

print(predicted)
print(walk)
for leg, gaits in walk.gaits.items():
    print(f"{leg:<6} {gaits[-1]}, slips {walk.slip[robot.legs.index(robot.leg(leg))] * 1e3:.1f} mm")
print(f"work {walk.work / walk.cycles * 1e3:.1f} mJ a cycle, cost {walk.cost_of_transport:.2f}")

# The first cycle starts from rest.
advance = float(walk.advance[1:].mean())
