"""A robot that several tests of this room ask about is predicted once."""

from functools import cache

import pytest

from stepwell.robot import Robot


@pytest.fixture(autouse=True, scope="session")
def predicted_once():
    with pytest.MonkeyPatch.context() as patch:
        # A prediction is a value that depends on the robot's value alone.
        patch.setattr(Robot, "predict", cache(Robot.predict))
        yield
