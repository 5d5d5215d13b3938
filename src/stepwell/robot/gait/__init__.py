"""What a robot will do, from statics alone."""

from stepwell.robot.gait.predict import (
    Flip,
    LegPrediction,
    Motion,
    Prediction,
    Push,
    PushEnd,
    depths,
    predict,
)
from stepwell.robot.gait.states import TOLERANCE, gait, states
