"""Pictures of a model, drawn off screen by a process of their own, and the cameras of them."""

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Floats, InputError, StepwellError, nearest_word
from stepwell.simulation.live import LiveParts
from stepwell.simulation.simulator import Model, mujoco

Frame = NDArray[np.uint8]

SYSTEMS = ("egl", "osmesa") if sys.platform == "linux" else ("",)
PATIENCE = 60.0  # how long a graphics system may take to start [s]
READY = b"ready\n"
FIELD = math.radians(30.0)  # vertical field of view
EDGE = 1.12  # the picture is larger than its contents by this factor

# Azimuth and elevation of the direction in which the camera looks [deg]: at an azimuth of 0 along
# x, the robot's way at the start, at 90 to the left of it.
VIEWS: Mapping[str, tuple[float, float]] = {
    "above": (90.0, -89.0),
    "side": (90.0, -12.0),
    "front": (180.0, -18.0),
    "three-quarter": (145.0, -28.0),
}


class VideoError(StepwellError, RuntimeError):
    """Frames cannot be drawn, or a file cannot be written; the text has an action."""


def view_angles(view: str | tuple[float, float]) -> tuple[float, float]:
    """Azimuth and elevation [deg] of a view: a name of VIEWS, "AZIMUTH,ELEVATION", or both numbers.

    Raises:
        ValueError: another name, or an elevation that is not from -90 to 90.
    """
    if view in VIEWS:
        return VIEWS[str(view)]
    try:
        azimuth, elevation = view.split(",") if isinstance(view, str) else view
        angles = float(azimuth), float(elevation)
    except ValueError:
        meant = nearest_word(str(view), VIEWS)
        hint = f" Did you mean {meant}?" if meant else ""
        raise InputError(
            f"view = {view!r}: must be {', '.join(VIEWS)}, or AZIMUTH,ELEVATION [deg].{hint}"
        ) from None
    if not (math.isfinite(angles[0]) and -90.0 <= angles[1] <= 90.0):
        raise InputError(f"view = {view!r}: the elevation must be from -90 to 90 deg.")
    return angles


@dataclass(frozen=True)
class Camera:
    """A camera, which may follow the body, and the size of its picture.

    Args:
        size: width and height [pixels].
        angles: azimuth and elevation [deg].
        target: (3,) point in the middle of the picture [m]; with `follows`, from the body's origin.
        distance: from the target [m].
        follows: whether the target moves with the body.
        lit: half the side of the square round the robot in which parts cast shadows [m].
        line: width of the drawn path [m]; 0 for none.
    """

    size: tuple[int, int]
    angles: tuple[float, float]
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distance: float = 1.0
    follows: bool = True
    lit: float = 0.3
    line: float = 0.0

    @property
    def axes(self) -> Floats:
        """(3, 3) unit vectors forward, to the right and up."""
        azimuth, elevation = np.radians(self.angles)
        level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        forward = np.cos(elevation) * level + [0.0, 0.0, np.sin(elevation)]
        right = np.array([np.sin(azimuth), -np.cos(azimuth), 0.0])
        return np.array([forward, right, np.cross(right, forward)])

    def round(self, points: Floats) -> "Camera":
        """The camera at the least distance that has all points (n, 3) [m] in its picture."""
        points = np.asarray(points, float)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        tangents = np.tan(FIELD / 2) * np.array([self.size[0] / self.size[1], 1.0]) / EDGE
        shift, distance = np.zeros(2), 0.0
        for _ in range(4):
            # The middle of the picture, which is not that of the points.
            middle = middle + shift @ self.axes[1:]
            forward, *across = ((points - middle) @ self.axes.T).T
            needed = [
                np.abs(one) / tangent - forward
                for one, tangent in zip(across, tangents, strict=True)
            ]
            distance = float(np.max(needed))
            seen = [one / (distance + forward) for one in across]
            shift = np.array([(one.min() + one.max()) / 2 * distance for one in seen])
        return replace(self, target=tuple(middle.tolist()), distance=distance)

    def pixels(self, points: Floats, body: Floats) -> Floats:
        """(n, 2) pixels from the upper left corner of points (n, 3) [m], for a body there [m]."""
        target = np.array(self.target) + (body * [1.0, 1.0, 0.0] if self.follows else 0.0)
        forward, right, up = ((points - target) @ self.axes.T).T
        scale = self.size[1] / 2 / np.tan(FIELD / 2) / (self.distance + forward)
        return np.stack([self.size[0] / 2 + scale * right, self.size[1] / 2 - scale * up], axis=1)


class DrawingProcess:
    """A process that draws a model, in the first graphics system that works; a context manager.

    Args:
        model: compiled.
        cameras: each gives one picture of a frame.
        goal: (x, y) and radius of a disc on the floor [m].

    Raises:
        VideoError: no graphics system works.
    """

    def __init__(
        self,
        model: Model,
        cameras: Sequence[Camera],
        goal: tuple[float, float, float] | None = None,
    ):
        self._cameras = tuple(cameras)
        self._folder = tempfile.TemporaryDirectory(prefix="stepwell-")
        file = Path(self._folder.name, "model.mjb")
        mujoco.mj_saveModel(model, str(file))
        task = {"cameras": [vars(camera) for camera in cameras], "goal": goal}
        words = [sys.executable, "-m", "stepwell.simulation.drawing", str(file), json.dumps(task)]
        pipe, tried = subprocess.PIPE, list[str]()
        for system in SYSTEMS:
            self._process = subprocess.Popen(
                words, stdin=pipe, stdout=pipe, stderr=pipe, env=_environment(system)
            )
            if _end(self._process.stdout).readline() == READY:
                return
            tried.append(f"({system or 'this system'}: {_last_line(self._process)})")
        self.close()
        raise VideoError(
            f"No video: frames cannot be drawn off screen. {' '.join(tried)} On Debian and Ubuntu, "
            "install libegl1 and libgl1-mesa-dri; figures do not need them."
        )

    def frames(self, position: Floats, path: Floats | Sequence[Any] = ()) -> list[Frame]:
        """One picture (height, width, 3) of each camera.

        `position` (nq,) is of the joints, `path` (n, 2) are new points of the path [m].
        """
        request = {"position": np.asarray(position).tolist(), "path": np.asarray(path).tolist()}
        try:
            pipe = _end(self._process.stdin)
            pipe.write(json.dumps(request).encode() + b"\n")
            pipe.flush()
        except (BrokenPipeError, ValueError):
            pass  # Reading says why.
        return [self._read(*camera.size) for camera in self._cameras]

    def _read(self, width: int, height: int) -> Frame:
        data = _end(self._process.stdout).read(width * height * 3)
        if len(data) < width * height * 3:
            why = _last_line(self._process)
            raise VideoError(f"No video: the drawing process ended early ({why}).")
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.communicate()
        self._folder.cleanup()

    def __enter__(self) -> "DrawingProcess":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def drawing_system() -> str | None:
    """The graphics system for frames off screen, in the order of videos; None without one."""
    for system in SYSTEMS:
        try:
            tried = subprocess.run(
                [sys.executable, "-c", "import mujoco; mujoco.GLContext(8, 8).make_current()"],
                env=_environment(system),
                capture_output=True,
                timeout=PATIENCE,
            )
        except subprocess.TimeoutExpired:
            continue
        if tried.returncode == 0:
            return system or "the system's own"
    return None


def _environment(system: str) -> dict[str, str]:
    given = {"MUJOCO_GL": system, "PYOPENGL_PLATFORM": system} if system else {}
    return os.environ | given


def _end(pipe: IO[bytes] | None) -> IO[bytes]:
    assert pipe is not None, "every end is a pipe"
    return pipe


def _last_line(process: subprocess.Popen[bytes]) -> str:
    try:
        _, errors = process.communicate(timeout=PATIENCE)
    except (BrokenPipeError, ValueError):
        errors = b""
    lines = [line for line in errors.decode(errors="replace").splitlines() if line.strip()]
    return lines[-1].strip() if lines else "it ended without a message"


LAMP = -40.0  # azimuth of the light from that of the camera [deg]
PATH = (0.84, 0.37, 0.0, 1.0)
GOAL = (0.0, 0.62, 0.45, 0.35)
SHADE = 0.18  # opacity of the shade under a part at the floor ...
FADES = 0.004  # ... which fades with this height [m]
OVER = 0.0006  # height over the floor of marks on it [m]


class _Scene:
    """The drawing process: a model, and its parts that are no bodies."""

    def __init__(self, mujoco: Any, model: Model, task: dict[str, Any]):
        self.mujoco, self.model, self.data = mujoco, model, mujoco.MjData(model)
        self.cameras, self.goal, self.path = task["cameras"], task["goal"], list[Any]()
        self.options = mujoco.MjvOption()
        self.options.geomgroup[4] = 0
        widths, heights = zip(*(camera["size"] for camera in self.cameras), strict=True)
        frame = model.vis.global_
        frame.fovy = math.degrees(FIELD)
        frame.offwidth = max(frame.offwidth, *widths)
        frame.offheight = max(frame.offheight, *heights)
        self.renderers = []
        for camera in self.cameras:
            # Read once, with the renderer.
            wide = 1.0 - math.sin(math.radians(camera["angles"][1]))
            model.vis.map.shadowclip = wide * camera["lit"] / model.stat.extent
            width, height = camera["size"]
            self.renderers.append(mujoco.Renderer(model, height, width, max_geom=5000))
        self.live = LiveParts(model)
        floor = model.geom("floor").id
        stands = (model.geom_contype & model.geom_conaffinity[floor]) > 0
        self.stands = np.flatnonzero(stands & (model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE))

    def move(self, request: dict[str, Any]) -> None:
        """Take on the next position, and lengthen the path."""
        self.data.qpos[:] = request["position"]
        self.path += request["path"]
        self.live.update(self.data)
        for step in ("mj_kinematics", "mj_comPos", "mj_camlight", "mj_tendon"):
            getattr(self.mujoco, step)(self.model, self.data)

    def picture(self, number: int) -> bytes:
        """One picture of the present position."""
        given, renderer = self.cameras[number], self.renderers[number]
        camera = self.mujoco.MjvCamera()
        camera.azimuth, camera.elevation = given["angles"]
        camera.distance, camera.lookat[:] = given["distance"], given["target"]
        if given["follows"]:
            camera.lookat[:2] += self.data.qpos[:2]
        # The lamp is behind the camera, to its left: where the floor is nearest to the lamp, MuJoCo
        # draws specks of shadow, which are then out of the picture.
        side = math.radians(camera.azimuth + LAMP)
        towards = np.array([math.cos(side), math.sin(side), -1.7]) / math.hypot(1.0, 1.7)
        self.data.light_xdir[0] = towards
        self.data.light_xpos[0] = camera.lookat - towards
        renderer.update_scene(self.data, camera, self.options)
        renderer.scene.flags[self.mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self.add_marks(renderer.scene, given["line"])
        return renderer.render().tobytes()

    def add_marks(self, scene: Any, line: float) -> None:
        """Draw shades, goal and path onto the floor."""
        for geom in self.stands:
            x, y, z = self.data.geom_xpos[geom]
            radius = self.model.geom_rbound[geom]
            dark = SHADE * math.exp(-max(z - radius, 0.0) / FADES)
            # Several discs make a softer edge.
            for wide in (1.0, 1.3, 1.6, 1.9):
                self.add_disc(scene, (x, y, OVER), wide * radius, (0.0, 0.0, 0.0, dark))
        if self.goal is not None:
            x, y, radius = self.goal
            self.add_disc(scene, (x, y, OVER), radius, GOAL)
        for a, b in pairwise(self.path if line > 0 else ()):
            if scene.ngeom >= scene.maxgeom:
                break
            geom, shape = scene.geoms[scene.ngeom], self.mujoco.mjtGeom.mjGEOM_CAPSULE
            colour, none = np.array(PATH, dtype=np.float32), np.zeros(3)
            self.mujoco.mjv_initGeom(geom, shape, none, none, np.eye(3).ravel(), colour)
            self.mujoco.mjv_connector(geom, shape, line, np.array([*a, OVER]), np.array([*b, OVER]))
            scene.ngeom += 1

    def add_disc(
        self, scene: Any, at: Sequence[float], radius: float, colour: Sequence[float]
    ) -> None:
        """Draw a flat disc."""
        size, flat = np.array([radius, 0.0001, 0.0]), np.eye(3).ravel()
        shape, rgba = self.mujoco.mjtGeom.mjGEOM_CYLINDER, np.array(colour, dtype=np.float32)
        geom = scene.geoms[scene.ngeom]
        self.mujoco.mjv_initGeom(geom, shape, size, np.array(at), flat, rgba)
        scene.ngeom += 1


def _draw(model_file: str, task: str) -> None:
    """Answer every request, a line of JSON, with the pictures of all cameras as bytes.

    The graphics system is chosen by an environment variable that is read once, when MuJoCo is
    imported. Separate processes can try several systems, and a driver that crashes ends only its
    own process.
    """
    # Directly, without `simulator`: here the graphics system is needed.
    mujoco: Any = import_module("mujoco")
    # Output of a driver must not end up between the frames.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    scene = _Scene(mujoco, mujoco.MjModel.from_binary_path(model_file), json.loads(task))
    out.write(READY)
    out.flush()
    for line in sys.stdin.buffer:
        scene.move(json.loads(line))
        for number in range(len(scene.cameras)):
            out.write(scene.picture(number))
        out.flush()


if __name__ == "__main__":
    _draw(*sys.argv[1:])
