"""Videos and pictures of walks and of runs in an arena."""

import io
import os
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stepwell import base
from stepwell.robot import TOLERANCE, Arena, Leg, Robot
from stepwell.simulation import parts
from stepwell.simulation.arenas.surroundings import HEIGHT
from stepwell.simulation.drawing import (
    FIELD,
    Camera,
    DrawingProcess,
    Frame,
    VideoError,
    view_angles,
)
from stepwell.simulation.mazes import Maze
from stepwell.simulation.model import spec
from stepwell.simulation.simulator import Model, mujoco
from stepwell.simulation.walks import Walk

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

View = str | tuple[float, float]

GIF_WIDTH = 480
GIF_COLOURS = 192
EDGE = 0.25  # reach of the antennas beyond the body's origin [m]
LIFTED = 0.06  # height of the labels over the floor [m] ...
OUTSIDE = 0.06  # ... and their distance from the leg [m] ...
FURTHER = 0.02  # ... beyond blocks that are made of parts [m]
INSET = 0.36  # width of the inset over that of the picture [1]
INCH = 0.0254  # [m]


def video(
    result: Walk | Maze,
    *files: str | os.PathLike[str],
    width: int = 960,
    height: int = 540,
    fps: int = 25,
    speed: float | None = None,
    view: View | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Path, ...]:
    """Write a run as a video, drawn off screen.

    The states of the cells are written beside each leg, in the colours of the figures, inner first;
    a dot is a cell between its stops.

    Args:
        result: a walk, followed by the camera; or a run in an arena, with the whole arena in view,
            the path drawn and a close-up of the robot in a corner.
        files: output files, .mp4 or .gif, each written atomically.
        width, height: of the picture [pixels], even numbers.
        fps: frames a second.
        speed: multiple of real time; by default 1 for a walk; in an arena, the one for a video of
            20 s.
        view: "above", "side", "front" or "three-quarter", or azimuth and elevation [deg] of the
            direction in which the camera looks, as numbers or as "145,-28"; three-quarter for a
            walk and from above in an arena by default.
        progress: called with (done, total) frames.

    Raises:
        ValueError: a file that is neither .mp4 nor .gif, an odd size, a speed that is not > 0, or
            another view.
        ExtraError: PyAV for MP4, or Pillow for GIF, is not installed.
        VideoError: neither EGL nor OSMesa works, or more frames than the limit.
    """
    targets = tuple(Path(file) for file in files)
    _require_usable(targets, width, height, speed)
    shots = _Shots(result, (width, height), view)
    walk = shots.walk
    if speed is None:
        speed = max(1.0, walk.time[-1] / 20.0) if isinstance(result, Maze) else 1.0
    count = (walk.time[-1] - max(walk.time[0], 0.0)) * fps / speed
    if count > base.most("frames"):
        text = base.problem("frames", count, "These are")
        raise VideoError(f"{text} Or use a higher speed.")
    begin = max(walk.time[0], 0.0) if walk.time[-1] > 0 else walk.time[0]
    times = np.arange(begin, walk.time[-1], speed / fps)
    # The samples that become frames.
    chosen = np.minimum(np.searchsorted(walk.time, times), len(walk.time) - 1)
    encoders = [encoder_of(target)(width, height, fps) for target in targets]
    shots.model.vis.quality.shadowsize = 2048
    with shots.drawing() as drawing:
        for done, sample in enumerate(chosen, 1):
            frame = shots.frame(drawing, sample, chosen[:done][-2:])
            for encoder in encoders:
                encoder.add(frame)
            base.notify(progress, done, len(chosen))
    for target, encoder in zip(targets, encoders, strict=True):
        base.write_atomic(target, encoder.finish())
    return targets


def picture(
    result: Walk | Maze,
    file: str | os.PathLike[str],
    *,
    time: float | None = None,
    view: View | None = None,
    size: tuple[float, float] = (0.170, 0.0956),
    dpi: int = 300,
) -> Path:
    """Write one moment of a run as a PNG picture for print, drawn as in `video`.

    Args:
        result: as for `video`.
        file: output file, .png, written atomically.
        time: the moment [s]; by default the last in which a foot is lifted, in an arena the end.
        view: as for `video`.
        size: width and height on paper [m].
        dpi: pixels per inch.

    Raises:
        ValueError: a file that is not .png, or another view.
        ExtraError: Pillow is not installed.
        VideoError: neither EGL nor OSMesa works.
    """
    base.need("figures")
    from PIL import Image

    target = Path(file)
    if target.suffix.lower() != ".png":
        raise base.InputError(f"{target}: must end in .png.")
    width, height = (2 * round(length / INCH * dpi / 2) for length in size)
    shots = _Shots(result, (width, height), view)
    walk = shots.walk
    moment = _telling(result) if time is None else time
    sample = min(int(np.searchsorted(walk.time, moment)), len(walk.time) - 1)
    with shots.drawing() as drawing:
        frame = shots.frame(drawing, sample, np.arange(0, sample + 1, max(1, sample // 2000)))
    out = io.BytesIO()
    Image.fromarray(frame).save(out, format="PNG", dpi=(dpi, dpi))
    base.write_atomic(target, out.getvalue())
    return target


def _telling(result: Walk | Maze) -> float:
    """The moment [s] that shows most: the end of a path, or the last one with a lifted foot."""
    if isinstance(result, Maze):
        return float(result.walk.time[-1])
    lifted = np.flatnonzero(result.foot_height.max(axis=1) > 0.9 * result.foot_height.max())
    return float(result.time[lifted[-1]])


def _require_usable(targets: Iterable[Path], width: int, height: int, speed: float | None) -> None:
    for target in targets:
        encoder_of(target)
    if width % 2 or height % 2 or width < 16 or height < 16:
        raise base.InputError(f"width, height = {width}, {height}: must be even and at least 16.")
    if speed is not None and not speed > 0:
        raise base.InputError(f"speed = {speed}: must be > 0.")


class _Shots:
    """The pictures of a run: a camera, or two for a run in an arena, and labels."""

    def __init__(self, result: Walk | Maze, size: tuple[int, int], view: View | None):
        self.walk = result.walk if isinstance(result, Maze) else result
        if len(self.walk.time) < 2:
            raise base.InputError("the run has no samples: it ended before the first one.")
        angles = None if view is None else view_angles(view)
        walk, self.maze = self.walk, isinstance(result, Maze)
        self.model: Model = spec(walk.robot, walk.arena, walk.settings).compile()
        around, shadows = _outline(self.model, walk), 1.5 * _reach(self.model)
        if self.maze:
            whole = _whole(walk, size, angles or (90.0, -75.0))
            small = 2 * round(INSET * size[0] / 2), 2 * round(INSET * size[1] / 2)
            # Walls hide the robot from a lower camera; left is left in both pictures.
            near = Camera(small, (90.0, -62.0), lit=shadows).round(around)
            self.cameras = [whole, near]
            self.corner = _free_corner(whole, _seen(walk), small)
        else:
            near = Camera(size, angles or view_angles("three-quarter"), lit=shadows).round(around)
            self.cameras, self.corner = [near], (0, 0)
        self.labels = Labels(walk.robot, max(near.size[1], round(0.6 * size[1])))

    def drawing(self) -> DrawingProcess:
        """The process that draws the pictures."""
        goal = self.walk.arena.goal if self.walk.arena and self.maze else None
        disc = (*goal.at, goal.radius) if goal else None
        return DrawingProcess(self.model, self.cameras, disc)

    def frame(self, drawing: DrawingProcess, sample: int, path: NDArray[np.intp]) -> Frame:
        """The picture at a sample, with the path through more samples."""
        walk, position = self.walk, self.walk.positions[sample]
        points = np.stack([walk.x[path], walk.y[path]], axis=1) if self.maze else ()
        frames = drawing.frames(position, points)
        fractions = [walk._share(leg.name)[sample] for leg in walk.robot.legs]
        near = self.labels.add(frames[-1], self.cameras[-1], position[:7], fractions)
        return _with_inset(frames[0], near, self.corner) if self.maze else near


def _corners(model: Model) -> base.Floats:
    """(n, 3) corners of the parts of a robot [m] at its start, from the floor under its origin."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    body = model.body("body").id
    shown = (model.body_rootid[model.geom_bodyid] == body) & (model.geom_rgba[:, 3] > 0)
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    boxes = [
        (model.geom_aabb[geom, :3] + model.geom_aabb[geom, 3:] * signs)
        @ data.geom_xmat[geom].reshape(3, 3).T
        + data.geom_xpos[geom]
        for geom in np.flatnonzero(shown)
    ]
    return np.concatenate(boxes) - data.qpos[:3] * [1.0, 1.0, 0.0]


def _reach(model: Model) -> float:
    """Largest distance of a part from the axis through the origin [m]."""
    return float(np.linalg.norm(_corners(model)[:, :2], axis=1).max())


def _outline(model: Model, walk: Walk) -> base.Floats:
    """(n, 3) points round a robot and its labels [m], in all directions that it takes."""
    x, y, z = _corners(model).T
    robot = walk.robot
    beside = [point for leg in robot.legs for point in (label_place(robot, leg), (*leg.at, LIFTED))]
    x, y, z = np.concatenate([[x, y, z], np.array(beside).T], axis=1)
    turns = walk.yaw - walk.yaw[0]
    turned = [
        np.stack([x * np.cos(a) - y * np.sin(a), x * np.sin(a) + y * np.cos(a), z], axis=1)
        for a in np.linspace(turns.min(), turns.max(), 9)
    ]
    return np.concatenate(turned)


def label_place(robot: Robot, leg: Leg) -> parts.Vec3:
    """Place of a leg's label in the frame of the body [m]."""
    outside = OUTSIDE + (FURTHER if robot.made else 0.0)
    return leg.at[0] - 0.02, leg.at[1] + leg.side * outside, LIFTED


def _seen(walk: Walk) -> base.Floats:
    """(n, 3) points of a run that have to be in view [m]: path, obstacles, goal."""
    arena = walk.arena or Arena()
    points = [*zip(walk.x + EDGE, walk.y + EDGE, strict=True)]
    points += [*zip(walk.x - EDGE, walk.y - EDGE, strict=True)]
    for wall in arena.walls:
        start, end = np.array(wall.start), np.array(wall.end)
        points += [tuple(start + (end - start) * part) for part in np.linspace(0.0, 1.0, 9)]
    for disc in (*arena.cylinders, *filter(None, [arena.goal])):
        points += [np.add(disc.at, disc.radius), np.subtract(disc.at, disc.radius)]
    flat = np.array(points)
    return np.concatenate(
        [np.c_[flat, np.zeros(len(flat))], np.c_[flat, np.full(len(flat), HEIGHT)]]
    )


def _whole(walk: Walk, size: tuple[int, int], angles: tuple[float, float]) -> Camera:
    """A camera that has the whole arena in view."""
    camera = Camera(size, angles, follows=False).round(_seen(walk))
    # Lines are two pixels wide in a picture of 540.
    line = 2 * camera.distance * np.tan(FIELD / 2) / 540
    return Camera(
        size, angles, camera.target, camera.distance, False, lit=0.45 * camera.distance, line=line
    )


def _free_corner(camera: Camera, points: base.Floats, size: tuple[int, int]) -> tuple[int, int]:
    """Upper left pixel of a picture in the corner with the fewest points."""
    pixels, gap = camera.pixels(points, np.zeros(3)), camera.size[1] // 60
    ends = [(gap, whole - part - gap) for whole, part in zip(camera.size, size, strict=True)]
    corners = [(x, y) for y in ends[1][::-1] for x in ends[0]]

    def hidden(corner: tuple[int, int]) -> int:
        inside = (pixels >= corner) & (pixels <= np.add(corner, size))
        return int(inside.all(axis=1).sum())

    return min(corners, key=hidden)


def _with_inset(frame: Frame, inset: Frame, corner: tuple[int, int]) -> Frame:
    """A picture with a smaller one in it, in a frame."""
    (x, y), (height, width, _) = corner, inset.shape
    frame, edge = frame.copy(), max(1, len(frame) // 270)
    frame[y - edge : y + height + edge, x - edge : x + width + edge] = 70
    frame[y : y + height, x : x + width] = inset
    return frame


class Labels:
    """States of the cells beside each leg of a robot, in the colours of the figures."""

    def __init__(self, robot: Robot, height: int):
        self.robot = robot
        self.size = max(10, round(height / 20))
        self.fonts: Any = None
        if base.have("figures"):
            from PIL import ImageFont

            self.fonts = ImageFont.load_default(self.size)

    def add(
        self, frame: Frame, camera: Camera, pose: base.Floats, fractions: Sequence[base.Floats]
    ) -> Frame:
        """A picture with the states, from the fraction of each cell's travel."""
        if self.fonts is None:
            return frame
        from PIL import Image, ImageDraw

        image = Image.fromarray(frame)
        draw = ImageDraw.Draw(image)
        points = []
        for leg in self.robot.legs:
            turned = np.empty(3)
            mujoco.mju_rotVecQuat(turned, np.array(label_place(self.robot, leg)), pose[3:7])
            points.append(turned + pose[:3] * [1.0, 1.0, 0.0])
        places = self._apart(camera.pixels(np.array(points), pose[:3]))
        for leg, (x, y), each in zip(self.robot.legs, places, fractions, strict=True):
            self._write(draw, (x, y), leg.name, each)
        return np.asarray(image)

    def _apart(self, places: base.Floats) -> base.Floats:
        """Places of labels that do not cover each other."""
        places = places.copy()
        lowest_first = np.argsort(-places[:, 1], kind="stable")
        for i, label in enumerate(lowest_first):
            for lower in lowest_first[:i]:
                near = np.abs(places[label] - places[lower]) < [6 * self.size, 1.7 * self.size]
                if near.all():
                    places[label, 1] = places[lower, 1] - 1.8 * self.size
        return places

    def _write(self, draw: Any, at: tuple[float, float], name: str, fractions: base.Floats) -> None:
        side, gap = 1.35 * self.size, 0.12 * self.size
        word = draw.textlength(f"{name} ", font=self.fonts)
        half = (word + len(fractions) * side) / 2 + 3 * gap, side / 2 + 2 * gap
        # Inside the picture.
        most = np.array(draw.im.size) - half
        x, y = np.clip(at, half, most)
        x -= half[0] - 3 * gap
        draw.rounded_rectangle(
            (
                x - 3 * gap,
                y - side / 2 - 2 * gap,
                x + word + len(fractions) * side + 2 * gap,
                y + side / 2 + 2 * gap,
            ),
            radius=2 * gap,
            fill=(255, 255, 255),
        )
        draw.text((x, y), name, fill=(34, 34, 34), font=self.fonts, anchor="lm")
        for number, fraction in enumerate(fractions):
            left = x + word + number * side
            colour = tuple(round(255 * part) for part in parts.BANDS[number % len(parts.BANDS)][:3])
            state = "0" if fraction <= TOLERANCE else "1" if fraction >= 1.0 - TOLERANCE else "·"
            draw.rounded_rectangle(
                (left + gap, y - side / 2, left + side - gap, y + side / 2), radius=gap, fill=colour
            )
            draw.text(
                (left + side / 2, y), state, fill=(255, 255, 255), font=self.fonts, anchor="mm"
            )


class _Mp4:
    """MP4 with H.264, encoded frame by frame."""

    def __init__(self, width: int, height: int, fps: int):
        base.need("video")
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
        base.need("figures")
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


_ENCODERS: dict[str, type[_Mp4] | type[_Gif]] = {".mp4": _Mp4, ".gif": _Gif}


def encoder_of(file: Path) -> type[_Mp4] | type[_Gif]:
    """The encoder of a video by the suffix of its file, or a `ValueError`."""
    if file.suffix.lower() not in _ENCODERS:
        raise base.InputError(f"{file}: must end in .mp4 or .gif.")
    return _ENCODERS[file.suffix.lower()]
