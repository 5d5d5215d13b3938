"""The animation: true to the path, whole or not written at all."""

import numpy as np
import pytest
from PIL.GifImagePlugin import GifImageFile

from figures.drawn import lines, points
from sizes import cases
from stepwell import figures, files
from stepwell.figures.motion.animation import _Scene
from stepwell.figures.motion.stroke_program import instants


@pytest.mark.slow
def test_a_gif_has_the_frames_and_the_time_asked_for(tmp_path):
    cycle = files.preset("paper-forward").cycle()
    file = figures.animation(cycle, tmp_path / "cycle.gif", seconds=2, fps=10)
    with GifImageFile(file) as movie:
        time = 0
        for k in range(movie.n_frames):
            movie.seek(k)
            time += movie.info["duration"]
        # Frames in which nothing moves may be merged; the time they last may not be lost.
        assert 15 <= movie.n_frames <= 20
        assert time == 2000
        assert movie.info["loop"] == 0
    assert file.stat().st_size < 300_000


@pytest.mark.slow
def test_paper_is_white_in_every_frame(tmp_path):
    cycle = files.preset("paper-forward").cycle()
    file = figures.animation(cycle, tmp_path / "cycle.gif", seconds=1, fps=5)
    with GifImageFile(file) as movie:
        for k in range(movie.n_frames):
            movie.seek(k)
            assert movie.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    cases(
        ["paper-cell-10-0", "three-wave", "force-control", "slack"],
        ["paper-cell-10-0", "force-control"],
    ),
)
def test_other_chains_and_actuators_move_too(tmp_path, name):
    file = figures.animation(files.preset(name).cycle(), tmp_path / "a.gif", seconds=1, fps=8)
    with GifImageFile(file) as movie:
        assert movie.n_frames > 4


def test_snaps_are_shown_at_fixed_stroke_and_end_where_the_path_lands():
    path = files.preset("paper-forward").cycle().path
    frames = instants(path, 8.0, 400)
    snapping = [k for k, frame in enumerate(frames) if frame.snap]
    stroke = np.array([np.sum(frames[k].travels) for k in snapping])
    events = [event.stroke for event in path.events if event.kind.name == "SNAP"]
    for value in stroke:
        assert min(abs(value - event) for event in events) < 1e-9
    # Both snaps are seen, each for about half a second.
    breaks = np.flatnonzero(np.diff(snapping) > 1)
    assert len(breaks) == 1
    assert 20 <= breaks[0] + 1 <= 30


def test_the_actuator_moves_at_constant_speed_between_snaps():
    path = files.preset("paper-via-10").cycle().path
    frames = instants(path, 8.0, 400)
    stroke = np.array([np.sum(frame.travels) for frame in frames])
    speed = np.abs(np.diff(stroke))
    moving = speed[speed > 1e-12]
    assert np.median(moving) == pytest.approx(moving.max(), rel=1e-6)
    assert len(moving) > 0.8 * len(speed)


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(["three-wave", "force-control"], ["force-control"]))
def test_a_program_moves_too_with_its_plan_below(tmp_path, name):
    chain = files.preset(name)
    program = chain.program("01" if len(chain) == 2 else "010", start="1" + "0" * (len(chain) - 1))
    sizes = []
    for result in (chain.cycle(), program, program.path):
        file = figures.animation(result, tmp_path / "a.gif", seconds=1, fps=5)
        with GifImageFile(file) as movie:
            sizes.append(movie.size)
            assert movie.n_frames > 3
            assert movie.convert("RGB").getpixel((0, 0)) == (255, 255, 255)
    cycle, planned, bare = sizes
    assert planned == bare
    assert planned[0] == cycle[0]
    assert planned[1] > cycle[1]


@pytest.mark.slow
def test_the_plan_shows_windows_and_where_the_actuator_is():
    program = files.preset("paper-forward").program("01", start="10")
    scene = _Scene(program, program.path)
    frames = instants(program.path, 4.0, 80)
    assert scene.plan is not None
    (bar,) = lines(scene.figure, "windows")
    (turn,) = program.turns
    assert points(bar)[:, 1] == pytest.approx([turn.low * 1e3, turn.high * 1e3])
    states = []
    for frame in frames:
        scene.shoot(frame)
        x, y = points(scene.plan)[0]
        turned = (turn.drive - program.begin) * 1e3
        expected = program.begin * 1e3 + (x if x <= turned else 2 * turned - x)
        assert y == pytest.approx(expected, abs=1e-9)
        states.append(scene.state.get_text())
    assert states[0] == "state 10"
    assert states[-1] in ("state 01", "state -1")


def test_a_cycle_has_no_plan():
    cycle = files.preset("paper-forward").cycle()
    assert _Scene(cycle, cycle.path).plan is None


@pytest.mark.slow
def test_progress_counts_every_frame(tmp_path):
    calls = []
    figures.animation(
        files.preset("paper-forward").cycle(),
        tmp_path / "cycle.gif",
        seconds=1,
        fps=5,
        progress=lambda done, total: calls.append((done, total)),
    )
    assert calls == [(k, 5) for k in range(1, 6)]


@pytest.mark.slow
def test_an_interruption_leaves_the_old_file_alone(tmp_path):
    file = tmp_path / "cycle.gif"
    file.write_bytes(b"old")

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        figures.animation(files.preset("paper-forward").cycle(), file, seconds=1, progress=stop)
    assert file.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["cycle.gif"]


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("cycle.gif", {"seconds": 0}, "seconds = 0: must be > 0"),
        ("cycle.gif", {"seconds": float("inf")}, "seconds = inf"),
        ("cycle.gif", {"fps": 60}, "fps = 60: must be > 0 and at most 50"),
        ("cycle.mp4", {}, "must end in .gif"),
    ],
)
def test_what_a_gif_cannot_show_is_refused(tmp_path, name, options, message):
    with pytest.raises(ValueError, match=message):
        figures.animation(files.preset("paper-forward").cycle(), tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []
