"""Cameras, pictures and labels of videos."""

from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import says
from simulation.robots import explorer, robot
from stepwell.simulation import maze, picture, spec, view_angles, walk
from stepwell.simulation.drawing import VIEWS, Camera, DrawingProcess
from stepwell.simulation.parts import BANDS
from stepwell.simulation.videos import Labels, _free_corner, _Shots

Image = pytest.importorskip("PIL.Image", reason="pictures are written with Pillow")
needs_graphics = pytest.mark.usefixtures("drawable")


def test_a_view_is_a_name_or_two_angles():
    assert view_angles("side") == VIEWS["side"]
    assert view_angles("30,-45") == view_angles((30, -45)) == (30.0, -45.0)


@pytest.mark.parametrize(
    ("view", "words"),
    [
        ("sid", ("above", "mean side?")),
        ("30", ("AZIMUTH,ELEVATION",)),
        ("30,-95", ("from -90 to 90",)),
        ("inf,0", ("from -90 to 90",)),
    ],
)
def test_another_view_is_refused_with_what_is_allowed(view, words):
    with pytest.raises(ValueError, match="view = ") as refusal:
        view_angles(view)
    says(str(refusal.value), *words)


@pytest.mark.parametrize("angles", [*VIEWS.values(), (20.0, 35.0)])
def test_a_camera_has_all_points_in_its_picture_and_they_fill_it(angles):
    points = np.random.default_rng(3).uniform([-1, 0, 0], [2, 0.5, 0.3], (200, 3))
    camera = Camera((640, 360), angles, follows=False).round(points)
    pixels = camera.pixels(points, np.zeros(3))
    assert (pixels >= 0).all() and (pixels <= camera.size).all()
    assert (np.ptp(pixels, axis=0) / camera.size).max() > 0.7


@pytest.fixture(scope="module")
def looked_at(drawable):
    """A camera of each view, and what one process draws for all of them."""
    model = spec(robot()).compile()
    cameras = {
        view: Camera((320, 240), view_angles(view), (0.4, 0.1, 0.0), 1.2, follows=False)
        for view in VIEWS
    }
    with DrawingProcess(model, [*cameras.values()], goal=(0.45, 0.05, 0.03)) as drawing:
        # The robot has green bands, too.
        frames = drawing.frames(model.key_qpos[0] - np.r_[9.0, 9.0, np.zeros(model.nq - 2)])
    return {view: (cameras[view], frame) for view, frame in zip(VIEWS, frames, strict=True)}


@pytest.mark.parametrize("view", VIEWS)
def test_a_point_is_drawn_at_the_pixel_that_is_computed(looked_at, view):
    camera, frame = looked_at[view]
    at = np.array([[0.45, 0.05, 0.0]])
    x, y = camera.pixels(at, np.zeros(3))[0]
    green = np.argwhere(frame[..., 1].astype(int) - frame[..., 0] > 25)
    assert len(green) > 20
    assert green.mean(axis=0)[::-1] == pytest.approx([x, y], abs=2.5)


@needs_graphics
def test_parts_cast_a_shadow_beside_the_robot_wherever_it_is():
    model = spec(robot()).compile()
    camera = Camera((320, 240), view_angles("above"), distance=0.5, lit=0.4)
    here = model.key_qpos[0]
    there = here + np.r_[2.0, 3.0, np.zeros(model.nq - 2)]
    with DrawingProcess(model, [camera]) as drawing:
        [[first], [second]] = [drawing.frames(position) for position in (here, there)]
    for frame in (first, second):
        grey = frame.astype(int)
        neutral = np.ptp(grey, axis=2) < 12
        light = np.median(grey[:40, :40])
        # Darker than the floor's darker squares, lighter than any part of the robot.
        assert (neutral & (grey[..., 0] < 0.75 * light)).sum() > 500
        assert light > 200


@needs_graphics
def test_a_picture_for_print_has_its_size_on_paper(tmp_path):
    way = walk(robot(), 0.1)
    file = picture(way, tmp_path / "still.png", view="side", size=(0.050, 0.030), dpi=300)
    with Image.open(file) as image:
        assert image.size == (590, 354)
        assert image.info["dpi"] == pytest.approx((300, 300), abs=0.1)
        assert len(image.getcolors(1 << 20)) > 100


def test_a_picture_that_is_no_png_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"must end in \.png"):
        picture(walk(robot(), 0.1), tmp_path / "still.jpg")


def test_states_are_written_in_the_colours_of_the_bands():
    one, frame = robot(), np.full((270, 480, 3), 255, np.uint8)
    camera = Camera((480, 270), view_angles("above"), distance=0.5)
    pose = np.r_[0.0, 0.0, 0.03, 1.0, 0.0, 0.0, 0.0]
    drawn = Labels(one, 270).add(frame, camera, pose, [np.array([0.0, 1.0])] * 2)
    colours = {tuple(colour) for colour in drawn.reshape(-1, 3)}
    assert {tuple(round(255 * part) for part in band[:3]) for band in BANDS[:2]} <= colours
    # Of the left leg in the upper half, of the right one in the lower half.
    inked = np.flatnonzero((drawn < 250).any(axis=(1, 2)))
    assert inked.min() < 135 < inked.max()
    moved = Labels(one, 270).add(frame, camera, pose, [np.array([0.5, 1.0])] * 2)
    assert not np.array_equal(drawn, moved)


def test_labels_do_not_cover_each_other():
    labels = Labels(robot(), 270)
    places = labels._apart(np.array([[100.0, 50.0], [104.0, 51.0], [300.0, 51.0]]))
    assert abs(places[0, 1] - places[1, 1]) > labels.size
    assert places[2].tolist() == [300.0, 51.0]


def test_the_close_up_is_in_the_emptiest_corner():
    camera = Camera((400, 200), view_angles("above"), distance=1.0, follows=False)
    points = np.array([[-0.6, 0.3, 0], [0.6, 0.3, 0], [0.6, -0.3, 0]])
    x, y = _free_corner(camera, points, (140, 70))
    assert x < 100 and y > 100


@needs_graphics
def test_a_run_in_an_arena_has_the_robot_a_second_time_in_a_frame():
    arena = sw.load_arena("cylinder")
    run = maze(replace(explorer(), title="an explorer"), arena, limit=1)
    shots = _Shots(run, (480, 270), None)
    with shots.drawing() as drawing:
        frame = shots.frame(drawing, 10, np.arange(10))
    (x, y), (width, height) = shots.corner, shots.cameras[1].size
    assert (frame[y - 1, x : x + width] == 70).all()
    antennas = (frame[..., 0].astype(int) - frame[..., 2]) > 90
    assert antennas[y : y + height, x : x + width].sum() > 40
