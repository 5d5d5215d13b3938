"""Videos of the jumps, throws and blows of a hopper."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from stepwell import base
from stepwell.base import Floats
from stepwell.robot import Task
from stepwell.simulation.drawing import Camera, DrawingProcess, VideoError, view_angles
from stepwell.simulation.hoppers.jumps import Jump
from stepwell.simulation.hoppers.model import hopper_spec
from stepwell.simulation.videos import encoder_of

View = str | tuple[float, float]

# Multiple of real time of a video [1], and duration of one at the usual speed [s].
_SLOWEST, _USUAL = 0.2, 8.0
_EDGE = 0.03  # round everything that moves [m]


def jump_video(
    jump: Jump,
    *files: str | os.PathLike[str],
    width: int = 960,
    height: int = 540,
    fps: int = 25,
    speed: float | None = None,
    view: View = "side",
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Path, ...]:
    """Write the jumps of a hopper as a video, drawn off screen by a camera that stands still.

    Args:
        jump: result of `jump`.
        files: output files, .mp4 or .gif, each written atomically.
        width, height: of the picture [pixels], even numbers.
        fps: frames a second.
        speed: multiple of real time; by default slower, for a video of up to 8 s.
        view: as for `video`.
        progress: called with (done, total) frames.

    Raises:
        ValueError: a file that is neither .mp4 nor .gif, or a speed that is not > 0.
        ExtraError: PyAV for MP4, or Pillow for GIF, is not installed.
        VideoError: neither EGL nor OSMesa works, or more frames than the limit.
    """
    targets = tuple(Path(file) for file in files)
    end = float(jump.time[-1])
    if speed is None:
        speed = min(max(end / _USUAL, _SLOWEST), 1.0)
    if not speed > 0:
        raise base.InputError(f"speed = {speed}: must be > 0.")
    if end * fps / speed > base.most("frames"):
        raise VideoError(base.problem("frames", end * fps / speed, "These are"))
    encoders = [encoder_of(target)(width, height, fps) for target in targets]
    chosen = np.searchsorted(jump.time, np.arange(0.0, end, speed / fps))
    settings = jump.settings
    model = hopper_spec(jump.hopper, settings.time_step, settings.contact_time).compile()
    camera = Camera((width, height), view_angles(view), follows=False).round(_seen(jump))
    with DrawingProcess(model, [camera]) as drawing:
        for done, sample in enumerate(np.minimum(chosen, len(jump.time) - 1), 1):
            (frame,) = drawing.frames(jump.positions[sample])
            for encoder in encoders:
                encoder.add(frame)
            base.notify(progress, done, len(chosen))
    for target, encoder in zip(targets, encoders, strict=True):
        base.write_atomic(target, encoder.finish())
    return targets


def _seen(jump: Jump) -> Floats:
    """(8, 3) corners of a box round everything that moves [m]."""
    hopper, (x, z) = jump.hopper, jump.centre.T
    wide = max(hopper.foot_length, hopper.body_size) / 2 + _EDGE
    if hopper.task is Task.THROW:
        # A ball that flies far leaves the picture.
        z = np.minimum(z, z[0] + 4.0 * hopper.body_size)
    tall = hopper.body_size + hopper.height / 2 + _EDGE
    ends = (x.min() - wide, x.max() + wide), (-wide / 4, wide / 4), (0.0, z.max() + tall)
    return np.array(np.meshgrid(*ends)).reshape(3, -1).T
