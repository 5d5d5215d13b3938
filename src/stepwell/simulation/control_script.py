"""Walk a robot in MuJoCo: the actuator loads and unloads the legs periodically.

    python walk.py                          in MuJoCo's viewer
    python walk.py --headless --cycles 4    without a display: prints the advance of each cycle

The script needs the packages mujoco and numpy, and the model robot.xml in its folder. The numbers
of the command are in the model, as `custom` fields.
"""

import argparse
from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco as simulator
import numpy as np

MODEL = Path(__file__).with_name("robot.xml")
mujoco: Any = simulator  # its compiled modules have no types


def number(model: Any, name: str) -> float:
    """One number of the model: `period` and `settle` [s], `u_max`, the largest step [m]."""
    return float(model.numeric(name).data[0])


def stroke(model: Any, time: float) -> float:
    """Commanded stroke [m] at a time [s] from the start of the first cycle; 0 before it."""
    phase = max(time, 0.0) / number(model, "period") % 1.0
    return float(np.interp(phase, model.numeric("phase").data, model.numeric("stroke").data))


def pose(data: Any) -> tuple[float, float, float]:
    """Position (x, y) [m] and heading [rad] of the body."""
    x, y, _, w, i, j, k = data.joint("body").qpos
    return x, y, np.arctan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))


def advances(model: Any, cycles: int) -> list[float]:
    """Advance of each cycle along the heading at its start, over u_max [1]."""
    data, step = mujoco.MjData(model), model.opt.timestep
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    first, period = (round(number(model, name) / step) for name in ("settle", "period"))
    poses = []
    for count in range(first + cycles * period + 1):
        if count >= first and (count - first) % period == 0:
            poses.append(pose(data))
        data.ctrl[0] = stroke(model, (count - first) * step)
        mujoco.mj_step(model, data)
    moved = [
        (end[0] - x) * np.cos(yaw) + (end[1] - y) * np.sin(yaw)
        for (x, y, yaw), end in pairwise(poses)
    ]
    return [float(one / number(model, "u_max")) for one in moved]


def turned(rest: Any, now: Any) -> Any:
    """The smallest rotation (w, x, y, z) from the direction of one vector (3,) to another's."""
    axis, turn = np.cross(rest, now), np.empty(4)
    angle = np.arctan2(np.linalg.norm(axis), rest @ now)
    mujoco.mju_axisAngle2Quat(turn, axis / max(np.linalg.norm(axis), 1e-12), angle)
    return turn


class Followers:
    """Bodies that are only drawn, each from its joint "near" to its joint "far" on other bodies."""

    def __init__(self, model: Any):
        names = {model.body(i).name: i for i in range(model.nbody) if model.body_mocapid[i] >= 0}
        self.ends = [
            (model.body_mocapid[body], model.site(f"near {part}").id, model.site(f"far {part}").id)
            for name, body in names.items()
            for part in [name.removeprefix("drawn ")]
        ]
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        mujoco.mj_kinematics(model, data)
        self.rest = [self.arrow(data, near, far) for _, near, far in self.ends]

    def arrow(self, data: Any, near: int, far: int) -> Any:
        """Vector between two points [m] in the frame of the robot's body."""
        return data.body("body").xmat.reshape(3, 3).T @ (data.site_xpos[far] - data.site_xpos[near])

    def update(self, data: Any) -> None:
        """Move them to their joints."""
        for (body, near, far), rest in zip(self.ends, self.rest, strict=True):
            turn = turned(rest, self.arrow(data, near, far))
            data.mocap_pos[body] = data.site_xpos[near]
            mujoco.mju_mulQuat(data.mocap_quat[body], data.body("body").xquat, turn)


def show(model: Any) -> None:
    """Walk in MuJoCo's viewer, from the keyframe `settled`; the mouse can push the robot."""
    from mujoco import viewer

    followers = Followers(model)

    def control(model: Any, data: Any) -> None:
        data.ctrl[0] = stroke(model, data.time)
        followers.update(data)

    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("settled").id)
    mujoco.set_mjcb_control(control)
    viewer.launch(model, data)


def main() -> None:
    """Read the options and walk."""
    parser = argparse.ArgumentParser(description="Walk a robot in MuJoCo.")
    parser.add_argument("--headless", action="store_true", help="print the advance of each cycle")
    parser.add_argument("--cycles", type=int, default=4, help="number of cycles without a display")
    given = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    if not given.headless:
        return show(model)
    for cycle, advance in enumerate(advances(model, given.cycles), 1):
        print(f"cycle {cycle}: advance {advance:.6f} u_max")


if __name__ == "__main__":
    main()
