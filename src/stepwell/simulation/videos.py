"""Videos of walks and of runs in an arena."""

import io
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stepwell.base import InputError, StepwellError, most, need, notify, problem, write_atomic
from stepwell.robot import Arena
from stepwell.simulation.mazes import Maze
from stepwell.simulation.model import spec
from stepwell.simulation.simulator import mujoco
from stepwell.simulation.walks import Walk

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

Frame = NDArray[np.uint8]

SYSTEMS = ("egl", "osmesa") if sys.platform == "linux" else ("",)
TRAIL = (0.84, 0.37, 0.0, 1.0)
PATIENCE = 60.0  # how long a graphics system may take to start [s]
# Reach of the antennas beyond the body's origin [m].
EDGE = 0.25
GIF_WIDTH = 480
GIF_COLOURS = 192
READY = b"ready\n"
GOAL = (0.0, 0.62, 0.45, 0.35)


class VideoError(StepwellError, RuntimeError):
    """Frames cannot be drawn, or a file cannot be written; the text has an action."""


def video(
    result: Walk | Maze,
    *files: str | os.PathLike[str],
    width: int = 960,
    height: int = 540,
    fps: int = 25,
    speed: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Path, ...]:
    """Write a run as a video, drawn off screen.

    Args:
        result: a walk, followed by the camera; or a run in an arena, with the whole arena in view
            and the path drawn.
        files: output files, .mp4 or .gif, each written atomically.
        width, height: of the picture [pixels], even numbers.
        fps: frames a second.
        speed: multiple of real time; by default 1 for a walk; in an arena, the one for a video of
            20 s.
        progress: called with (done, total) frames.

    Raises:
        ValueError: a file that is neither .mp4 nor .gif, an odd size, or a speed that is not > 0.
        ExtraError: PyAV for MP4, or Pillow for GIF, is not installed.
        VideoError: neither EGL nor OSMesa works, or more frames than the limit.
    """
    targets = tuple(Path(file) for file in files)
    _require_usable(targets, width, height, speed)
    walk = result.walk if isinstance(result, Maze) else result
    if len(walk.time) < 2:
        raise InputError("the run has no samples: it ended before the first one.")
    if speed is None:
        speed = max(1.0, walk.time[-1] / 20.0) if isinstance(result, Maze) else 1.0
    count = (walk.time[-1] - max(walk.time[0], 0.0)) * fps / speed
    if count > most("frames"):
        raise VideoError(f"{problem('frames', count, 'These are')} Or use a higher speed.")
    begin = max(walk.time[0], 0.0) if walk.time[-1] > 0 else walk.time[0]
    times = np.arange(begin, walk.time[-1], speed / fps)
    # The samples that become frames.
    chosen = np.minimum(np.searchsorted(walk.time, times), len(walk.time) - 1)
    encoders = [_ENCODERS[target.suffix.lower()](width, height, fps) for target in targets]
    with _drawn(walk, result, chosen, width, height) as frames:
        for done, frame in enumerate(frames, 1):
            for encoder in encoders:
                encoder.add(frame)
            notify(progress, done, len(chosen))
    for target, encoder in zip(targets, encoders, strict=True):
        write_atomic(target, encoder.finish())
    return targets


def _require_usable(targets: Iterable[Path], width: int, height: int, speed: float | None) -> None:
    for target in targets:
        if target.suffix.lower() not in _ENCODERS:
            raise InputError(f"{target}: must end in .mp4 or .gif.")
    if width % 2 or height % 2 or width < 16 or height < 16:
        raise InputError(f"width, height = {width}, {height}: must be even and at least 16.")
    if speed is not None and not speed > 0:
        raise InputError(f"speed = {speed}: must be > 0.")


@contextmanager
def _drawn(
    walk: Walk, result: Walk | Maze, chosen: NDArray[np.intp], width: int, height: int
) -> Iterator[Iterator[Frame]]:
    """The frames, from the first graphics system that works."""
    with tempfile.TemporaryDirectory(prefix="stepwell-") as folder:
        model, run = Path(folder, "model.mjb"), Path(folder, "run.npz")
        mujoco.mj_saveModel(spec(walk.robot, walk.arena, walk.settings).compile(), str(model))
        trail = np.stack([walk.x, walk.y, np.full(len(walk.x), 0.002)], axis=1)[chosen]
        np.savez(
            run,
            view=json.dumps(_view(walk, isinstance(result, Maze), width, height)),
            positions=walk.positions[chosen],
            trail=trail if isinstance(result, Maze) else trail[:0],
        )
        tried: list[str] = []
        drawing = [sys.executable, "-m", "stepwell.simulation.videos", str(model), str(run)]
        pipe = subprocess.PIPE
        for system in SYSTEMS:
            process = subprocess.Popen(drawing, stdout=pipe, stderr=pipe, env=_environment(system))
            assert process.stdout is not None
            try:
                if process.stdout.readline() == READY:
                    yield _frames(process, len(chosen), width, height)
                    return
                tried.append(f"{system or 'this system'}: {_last_line(process)}")
            finally:
                process.kill()
                process.communicate()
        raise VideoError(
            "No video: frames cannot be drawn off screen. "
            + " ".join(f"({one})" for one in tried)
            + " On Debian and Ubuntu, install libegl1 and libgl1-mesa-dri; figures do not need "
            "them."
        )


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


def _last_line(process: subprocess.Popen[bytes]) -> str:
    _, errors = process.communicate(timeout=PATIENCE)
    lines = [line for line in errors.decode(errors="replace").splitlines() if line.strip()]
    return lines[-1].strip() if lines else "it ended without a message"


def _frames(
    process: subprocess.Popen[bytes], count: int, width: int, height: int
) -> Iterator[Frame]:
    assert process.stdout is not None
    size = width * height * 3
    for _ in range(count):
        data = process.stdout.read(size)
        if len(data) < size:
            raise VideoError(f"No video: the drawing process ended early ({_last_line(process)}).")
        yield np.frombuffer(data, np.uint8).reshape(height, width, 3)


def _view(walk: Walk, whole: bool, width: int, height: int) -> dict[str, object]:
    view: dict[str, object] = {"width": width, "height": height, "trail": TRAIL}
    if not whole:
        near = {"camera": (0.36, 145.0, -28.0), "lookat": (0.0, 0.0, 0.015)}
        return view | near | {"follow": True, "width_m": 0.001, "shadows": True}
    arena = walk.arena or Arena()
    if arena.goal is not None:
        view["goal"] = (*arena.goal.at, arena.goal.radius)
    # All points in view [m].
    points = [*zip(walk.x, walk.y, strict=True)]
    points += [end for wall in arena.walls for end in (wall.start, wall.end)]
    for disc in (*arena.cylinders, *filter(None, [arena.goal])):
        points += [np.add(disc.at, disc.radius), np.subtract(disc.at, disc.radius)]
    low, high = np.min(points, axis=0) - EDGE, np.max(points, axis=0) + EDGE
    middle, size = (low + high) / 2, high - low
    # MuJoCo's free camera has a vertical field of view of 45°; 10 % more leaves an edge.
    across = max(size[1], size[0] * height / width) * 1.10
    return view | {
        "camera": (across / 2 / np.tan(np.radians(22.5)), 90.0, -75.0),
        "lookat": (*middle, 0.0),
        "follow": False,
        "shadows": False,
        "width_m": 0.002 * max(1.0, across),
    }


class _Mp4:
    """MP4 with H.264, encoded frame by frame."""

    def __init__(self, width: int, height: int, fps: int):
        need("video")
        import av

        self._out = io.BytesIO()
        self._container = av.open(self._out, "w", format="mp4")
        self._stream = self._container.add_stream("libx264", rate=Fraction(fps))
        self._stream.width, self._stream.height = width, height
        self._stream.pix_fmt = "yuv420p"
        self._stream.options = {"crf": "20", "preset": "fast"}
        self._picture = av.VideoFrame.from_ndarray

    def add(self, frame: Frame) -> None:
        picture = self._picture(frame, format="rgb24")
        self._container.mux(self._stream.encode(picture))

    def finish(self) -> bytes:
        self._container.mux(self._stream.encode())
        self._container.close()
        return self._out.getvalue()


class _Gif:
    """GIF with fewer and smaller frames, in one palette."""

    def __init__(self, width: int, height: int, fps: int):
        need("figures")
        from PIL import Image

        self._image = Image
        # A GIF stores times in hundredths of a second, and viewers slow down frames shorter than
        # two of them.
        self._every = max(1, round(fps / 12.5))
        self._duration = round(100 * self._every / fps) * 10
        self._size = (min(GIF_WIDTH, width), round(height * min(GIF_WIDTH, width) / width))
        self._pictures: list[Picture] = []
        self._seen = 0

    def add(self, frame: Frame) -> None:
        if self._seen % self._every == 0:
            self._pictures.append(self._image.fromarray(frame).resize(self._size))
        self._seen += 1

    def finish(self) -> bytes:
        # Colours of later frames only, such as the path, must be in the palette too.
        first, *_, last = self._pictures * 2
        both = self._image.new("RGB", (self._size[0], 2 * self._size[1]))
        both.paste(first, (0, 0))
        both.paste(last, (0, self._size[1]))
        palette = both.quantize(GIF_COLOURS, self._image.Quantize.MAXCOVERAGE)
        pictures = [
            picture.quantize(palette=palette, dither=self._image.Dither.NONE)
            for picture in self._pictures
        ]
        out, timed = io.BytesIO(), {"duration": self._duration, "loop": 0}
        pictures[0].save(out, format="GIF", save_all=True, append_images=pictures[1:], **timed)
        return out.getvalue()


_ENCODERS = {".mp4": _Mp4, ".gif": _Gif}


def _draw_frames(model_file: str, run_file: str) -> None:
    """Write every frame to the output of a separate process, as height x width x 3 bytes.

    The graphics system is chosen by an environment variable that is read once, when MuJoCo is
    imported. Separate processes can try several systems, and a driver that crashes ends only its
    own process.
    """
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
    _draw_frames(*sys.argv[1:])
