"""Frames of a run, drawn off screen by a separate process and written to its output.

The graphics system is chosen by an environment variable that is read once, when MuJoCo is
imported. Separate processes can try several systems, and a driver that crashes ends only its own
process.
"""

import json
import os
import sys
from importlib import import_module
from itertools import pairwise
from typing import Any

import numpy as np

READY = b"ready\n"
GOAL = (0.0, 0.62, 0.45, 0.35)


def main(model_file: str, run_file: str) -> None:
    """Draw every frame as height x width x 3 bytes."""
    # Directly, without `simulator`: here the graphics system is needed.
    mujoco: Any = import_module("mujoco")
    # Output of a driver must not end up between the frames.
    frames = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    run = np.load(run_file)
    view = json.loads(str(run["view"]))
    model = mujoco.MjModel.from_binary_path(model_file)
    data = mujoco.MjData(model)
    renderer = mujoco.Renderer(model, view["height"], view["width"], max_geom=5000)
    frames.write(READY)
    camera = mujoco.MjvCamera()
    camera.distance, camera.azimuth, camera.elevation = view["camera"]
    camera.lookat[:] = view["lookat"]
    options = mujoco.MjvOption()
    options.geomgroup[4] = 0
    trail = run["trail"]
    # Shadows and reflections take most of a software renderer's time.
    for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
        renderer.scene.flags[flag] = view["shadows"]
    for frame, position in enumerate(run["positions"]):
        data.qpos[:] = position
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        mujoco.mj_tendon(model, data)
        if view["follow"]:
            camera.lookat[:2] = position[:2]
        renderer.update_scene(data, camera, options)
        scene = renderer.scene
        if "goal" in view:
            x, y, radius = view["goal"]
            disc = scene.geoms[scene.ngeom]
            size, place = np.array([radius, 0.0005, 0.0]), np.array([x, y, 0.0005])
            colour = np.array(GOAL, dtype=np.float32)
            shape = mujoco.mjtGeom.mjGEOM_CYLINDER
            mujoco.mjv_initGeom(disc, shape, size, place, np.eye(3).ravel(), colour)
            scene.ngeom += 1
        for a, b in pairwise(trail[: frame + 1]):
            if scene.ngeom >= scene.maxgeom:
                break
            geom = scene.geoms[scene.ngeom]
            shape = mujoco.mjtGeom.mjGEOM_CAPSULE
            colour = np.array(view["trail"], dtype=np.float32)
            mujoco.mjv_initGeom(geom, shape, np.zeros(3), np.zeros(3), np.eye(3).ravel(), colour)
            mujoco.mjv_connector(geom, shape, view["width_m"], a, b)
            scene.ngeom += 1
        frames.write(renderer.render().tobytes())
    frames.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
