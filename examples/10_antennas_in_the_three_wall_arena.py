"""Antennas that reprogram legs steer a robot past three walls; without their levers they do not."""

from dataclasses import replace

import stepwell as sw
from stepwell.files import load_arena

robot, arena = sw.preset("robot-antennas"), load_arena("three-walls")
cut = tuple(replace(antenna, connected=False) for antenna in robot.antennas)

way = robot.maze(arena)
# Long enough for two walls, if it got past the first.
control = replace(robot, antennas=cut).maze(arena, limit=200.0)
for name, maze in (("as built", way), ("levers off", control)):
    touched = [obstacle for obstacle, time in maze.touched.items() if time is not None]
    print(f"{name:<10} {maze.outcome} after {maze.duration:.0f} s, touched {', '.join(touched)}")

for contact in way.contacts:
    print(f"{contact.antenna:<6} antenna pressed from {contact.begin:.1f} s to {contact.end:.1f} s")
    for change in way.changes:
        if contact.begin <= change.time <= contact.end + 2 * robot.drive.period:
            print(f"       {change.leg} leg: {change.before} becomes {change.after}")

reached_and_touched = (str(way.outcome), sum(time is not None for time in way.touched.values()))
