"""Claims about the robot, each found by simulating it."""

from stepwell.paper.robots.antennas import CLAIMS as ANTENNAS
from stepwell.paper.robots.loss import CLAIMS as LOSS
from stepwell.paper.robots.robot import CLAIMS as ROBOT, robot, walk_of
from stepwell.paper.robots.sensitivity import sensitivities
from stepwell.paper.robots.steering import CLAIMS as STEERING, MANY_RUNS
