"""What a chain does as its actuator moves."""

from stepwell.figures.motion.animation import animation
from stepwell.figures.motion.force_stroke import force_stroke
from stepwell.figures.motion.landscape import landscape
from stepwell.figures.motion.moving import moving
from stepwell.figures.motion.overview import overview
from stepwell.figures.motion.snap_motion import snap_motion
from stepwell.figures.motion.standard import standard, standard_draws
from stepwell.figures.motion.stroke_program import stroke_program
from stepwell.figures.motion.travel_stroke import travel_stroke
