"""What a robot will do, from statics alone."""

from stepwell.robot.gait.predict import (
    DriveNeeds,
    Flip,
    LegPrediction,
    Motion,
    Prediction,
    Push,
    PushEnd,
    depths,
    predict,
    predicted_gaits,
    too_soft,
)
from stepwell.robot.gait.states import TOLERANCE, gait, states
