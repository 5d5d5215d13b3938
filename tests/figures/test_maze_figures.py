"""The way through an arena and its timeline: obstacles, path, contacts and gaits in place."""

import math
from functools import cache, partial
from itertools import product

import numpy as np
import pytest
from matplotlib.patches import Circle, Polygon

from facts import says as holds
from figures.drawn import lines, points, says, untidy, untidy_on_a_phone
from figures.robots import cut, explorer, walker
from figures.shapes import boxes, strips
from sizes import cases
from stepwell import figures
from stepwell.robot import Arena, Cylinder, Goal, Wall
from stepwell.simulation import Maze, Outcome, maze


@pytest.fixture(scope="module")
def touching():
    # Close enough that an antenna meets the cylinder, and lets go of it, in this time.
    wall = Wall((-0.30, 0.20), (0.18, 0.56))
    return maze(explorer(), Arena([wall], [Cylinder((0.26, 0.06))], title="cylinder"), limit=44.0)


@pytest.fixture(scope="module")
def mazes(touching):
    near = Arena(goal=Goal((0.10, 0.0), 0.08), title="open floor")
    bare = Arena()
    return {
        "touching": touching,
        "goal": maze(explorer(), near, limit=20.0),
        "no obstacles, no goal": maze(explorer(), bare, limit=3.0),
        "no antennas": maze(walker(), bare, limit=3.0),
        "no whole cycle": maze(explorer(), bare, limit=1.0),
        "stopped": Maze(cut(touching.walk, 700, "Stopped at 14 s: the robot fell over."),
                        touching.arena, Outcome.STOPPED, 30.0),
    }  # fmt: skip


@pytest.fixture(scope="module")
def drawn(touching):
    """Both figures of the way at which most tests look: each is drawn once."""
    return cache(lambda draw: draw(touching))


KINDS = (
    "touching", "goal", "no obstacles, no goal", "no antennas", "no whole cycle", "stopped",
)  # fmt: skip


DRAWINGS = figures.maze, figures.maze_timeline
# Each figure with all that it can hold, and with the least.
HARDEST = [
    *((figures.maze, kind) for kind in ("touching", "goal", "no obstacles, no goal")),
    *((figures.maze_timeline, kind) for kind in ("touching", "no antennas", "no whole cycle")),
]


@pytest.mark.slow
@pytest.mark.parametrize(("draw", "kind"), cases(product(DRAWINGS, KINDS), HARDEST))
def test_every_way_is_drawn_with_words_apart_on_a_page_and_on_a_phone(draw, kind, mazes):
    assert untidy(draw(mazes[kind]), 7.0) == []
    assert untidy_on_a_phone(partial(draw, mazes[kind])) == []


@pytest.mark.parametrize("draw", [figures.maze, figures.maze_timeline])
def test_a_walk_without_samples_is_refused(draw, touching):
    none = Maze(cut(touching.walk, 0), touching.arena, Outcome.STOPPED, 30.0)
    with pytest.raises(ValueError, match="no samples"):
        draw(none)


def test_the_title_says_the_outcome(mazes):
    holds(says(figures.maze(mazes["touching"])), "cylinder: ", "away from cylinder 1")
    said = says(figures.maze(mazes["goal"]))
    holds(said, "open floor: ", "reached the goal", " s")
    assert {"start", "end", "goal"} <= set(said)


def test_obstacles_stand_in_their_place_and_are_dark_where_touched(touching, drawn):
    ax = drawn(figures.maze).axes[0]
    touched = [name for name, time in touching.touched.items() if time is not None]
    assert touched == ["cylinder 1"]
    (wall,) = [p for p in ax.patches if p.get_gid() == "obstacle"]
    assert isinstance(wall, Polygon)
    corners = np.asarray(wall.get_xy())[:4]
    assert corners.mean(axis=0) == pytest.approx((-60.0, 380.0))
    assert np.hypot(*(corners[1] - corners[0])) == pytest.approx(600.0)
    assert np.hypot(*(corners[2] - corners[1])) == pytest.approx(20.0)
    (round_,) = [p for p in ax.patches if p.get_gid() == "touched obstacle"]
    assert isinstance(round_, Circle)
    assert round_.get_center() == pytest.approx((260.0, 60.0))
    assert round_.get_radius() == pytest.approx(25.0)


def test_the_path_goes_through_every_sample_once_coloured(touching, drawn):
    figure = drawn(figures.maze)
    path = [points(line) for ax in figure.axes for line in ax.get_lines()
            if str(line.get_gid()).startswith("path")]  # fmt: skip
    places = {tuple(xy) for line in path for xy in line if np.isfinite(xy).all()}
    walk = touching.walk
    assert places == set(zip((walk.x * 1e3).tolist(), (walk.y * 1e3).tolist(), strict=True))
    gids = {line.get_gid() for ax in figure.axes for line in ax.get_lines()}
    # The left antenna was pressed, which makes the right leg step back.
    assert {"path forward", "path turning right"} <= gids
    assert "path turning left" not in gids


def test_presses_are_marked_where_the_body_was(touching, drawn):
    assert touching.contacts
    (marked,) = lines(drawn(figures.maze), "pressed")
    first = touching.contacts[0]
    walk = touching.walk
    i = int(np.searchsorted(walk.time, first.begin))
    assert points(marked)[0] == pytest.approx((walk.x[i] * 1e3, walk.y[i] * 1e3))
    assert lines(drawn(figures.maze_timeline), "pressed") == []


def test_antennas_are_drawn_as_far_back_as_they_are_pressed(touching, drawn):
    walk = touching.walk
    press = touching.contacts[0]
    sample = int(np.searchsorted(walk.time, (press.begin + press.end) / 2))
    index = [one.name for one in walk.robot.antennas].index(press.antenna)
    antenna = walk.robot.antennas[index]
    angle = antenna.angle + antenna.side * walk.antenna[sample, index] + walk.yaw[sample]
    angles = []
    for line in lines(drawn(figures.maze), f"antenna {press.antenna}"):
        along = points(line)[1] - points(line)[0]
        angles.append(math.atan2(along[1], along[0]))
    assert min(abs(math.remainder(one - angle, 2 * math.pi)) for one in angles) < 1e-9


@pytest.mark.slow
def test_the_scale_bar_has_the_length_it_says(mazes):
    for one in mazes.values():
        figure = figures.maze(one)
        (bar,) = lines(figure, "scale bar")
        length = np.ptp(points(bar)[:, 0])
        label = f"{length:g} mm" if length < 1000 else f"{length / 1000:g} m"
        assert label in says(figure)


@pytest.mark.slow
def test_the_timeline_shows_swings_in_degrees_and_shades_contacts(touching, drawn):
    figure = drawn(figures.maze_timeline)
    walk = touching.walk
    for i, line in enumerate(lines(figure, "swing")):
        assert points(line)[:, 1] == pytest.approx(np.degrees(walk.antenna[:, i]))
    shaded = sorted(box.get_x() for box in boxes(figure, "contact"))
    assert shaded == pytest.approx([one.begin for one in touching.contacts])
    assert figure.axes[0].get_ylabel() == "left\nantenna [°]"
    assert figure.axes[-1].get_xlabel() == "Time [s]"


def test_strips_have_the_gait_of_each_leg_in_every_cycle(touching, drawn):
    figure = drawn(figures.maze_timeline)
    strip = figure.axes[2]
    legs = [text.get_text() for text in strip.get_yticklabels()]
    assert legs == ["left leg", "right leg"]
    period = touching.walk.robot.drive.period
    for leg, gaits in touching.walk.gaits.items():
        for cycle, gait in enumerate(gaits):
            spans = strips(strip, f"{leg} {gait}")
            assert any(abs(begin - cycle * period) < 1e-9 for begin, _ in spans), (leg, cycle)
    assert len(lines(figure, "change")) == len(touching.changes) > 0
    assert any(
        text.get_text() == "00>10>11>01>00, forward" for text in figure.legends[0].get_texts()
    )


def test_only_touched_obstacles_have_a_strip(touching, drawn):
    last = drawn(figures.maze_timeline).axes[-1]
    assert [text.get_text() for text in last.get_yticklabels()] == ["cylinder 1"]
    felt = strips(last, "cylinder 1")
    assert min(begin for begin, _ in felt) == pytest.approx(touching.touched["cylinder 1"])
