"""Arenas: tables in millimetres, maps drawn with letters, and those of the package."""

import math

import pytest
from hypothesis import assume, given, strategies as st

from facts import refuses, says
from stepwell.files import (
    DesignError,
    arena_text,
    arenas,
    dumps,
    load_arena,
    loads_arena,
    save,
    vary_arena,
)
from stepwell.robot import Arena, Cylinder, Goal, Patch, Plate, Slope, Wall, other_start

NAMES = tuple(arenas())


def answer(text: str, name: str = "arena.toml") -> str:
    with pytest.raises(DesignError) as caught:
        loads_arena(text, name)
    return str(caught.value)


def drawn(*rows: str, size: int = 100) -> Arena:
    return loads_arena("\n".join([f"cell {size} mm", *rows]))


def test_every_key_is_read_in_its_unit():
    arena = loads_arena(
        """
        title = "All of it"
        start_mm = [10, -20]
        heading_deg = 45
        [goal]
        at_mm = [2000, 0]
        radius_mm = 300
        [[wall]]
        from_mm = [400, -300]
        to_mm = [700, 300]
        thickness_mm = 10
        [[wall]]
        from_mm = [1000, 0]
        to_mm = [1000, 500]
        [[cylinder]]
        at_mm = [0, 500]
        radius_mm = 30
        """
    )
    walls = (Wall((0.4, -0.3), (0.7, 0.3), 0.01), Wall((1.0, 0.0), (1.0, 0.5)))
    cylinders = (Cylinder((0.0, 0.5), 0.03),)
    goal = Goal((2.0, 0.0), 0.3)
    assert arena == Arena(walls, cylinders, (0.01, -0.02), math.pi / 4, goal, "All of it")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "",
            "arena.toml: is empty: an arena is tables, as in start_mm = [0, 0], or a map below: "
            "cell 100 mm",
        ),
        ("start = [0, 0]", "arena.toml: start: unknown key. Did you mean start_mm?"),
        ("[[walls]]\nfrom_mm = [0, 0]", "arena.toml: walls: unknown key. Did you mean wall?"),
        (
            "[[wall]]\nfrom_mm = [1, 1]",
            "arena.toml: wall[0].to_mm: is missing. Two numbers in mm, as in [0, 600].",
        ),
        (
            "[[wall]]\nfrom_mm = [1, 1]\nto_mm = [1, 1]",
            "arena.toml: wall[0]: start = end = (0.001, 0.001): a wall needs two different ends.",
        ),
        (
            "[[cylinder]]\nat_mm = [1, 1]\nradius_mm = 0",
            "arena.toml: cylinder[0].radius_mm = 0: must be > 0 (1e-6 to 1e6).",
        ),
        (
            "start_mm = [10, 0]\n[[cylinder]]\nat_mm = [0, 0]",
            "arena.toml: start = (10, 0) mm lies 15 mm inside an obstacle; move the start.",
        ),
        (
            "[wall]\nfrom_mm = [0, 0]",
            "arena.toml: wall = {from_mm}: must be a list of tables, each under [[wall]].",
        ),
        ("x = = 1", "arena.toml: line 1, column 5: Invalid value."),
        # maps
        (
            "cell 100\nS",
            'arena.toml: line 1: "cell 100": must be the size of one letter of the map, from 1 to '
            "10000 mm, as in: cell 100 mm",
        ),
        (
            "cell 1e9 mm\nS",
            'arena.toml: line 1: "cell 1e9 mm": must be the size of one letter of the map, from 1 '
            "to 10000 mm, as in: cell 100 mm",
        ),
        (
            "cell 100 mm\n",
            "arena.toml: has no map below its first line: add rows of # (wall), o (cylinder), "
            "S > < ^ v (start), G (goal), a point or a space (floor).",
        ),
        (
            "cell 100 mm\ntitle T\nS..\n..x",
            'arena.toml: line 4, column 3: "x": must be one of # (wall), o (cylinder), S > < ^ v '
            "(start), G (goal), a point or a space (floor).",
        ),
        (
            "cell 100 mm\n#.#",
            "arena.toml: has no start: put S on the floor, or > < ^ v for a start with a heading.",
        ),
        (
            "cell 100 mm\nS.#\n.^#",
            "arena.toml: line 3, column 2: a second start: the first one is in line 2, column 1.",
        ),
        (
            "cell 100 mm\nS.GG",
            "arena.toml: line 2, column 4: a second goal: the first one is in line 2, column 3.",
        ),
        (
            "cell 20 mm\nSo",
            "arena.toml: start = (10, 10) mm lies 5 mm inside an obstacle; move the start.",
        ),
        (
            "cell 100 mm\nS" + 160_000 * ".",
            "arena.toml: has 160001 letters of a map: at most 160000 are taken; "
            "STEPWELL_LIMITS=letters=160001 in the environment allows as many. Or use a larger "
            "size of a letter.",
        ),
    ],
)
def test_the_message_names_the_place_the_value_and_the_remedy(text, message):
    assert answer(text) == message


def test_a_text_file_is_a_map_whatever_it_starts_with(tmp_path):
    (tmp_path / "mine.txt").write_text("#####\nS....\n")
    with refuses(DesignError, "mine.txt: ", "line 1", '"#####"', "1 to 10000 mm", "cell 100 mm"):
        load_arena(tmp_path / "mine.txt")
    (tmp_path / "mine.txt").write_bytes(b"\xef\xbb\xbfcell 50 mm\r\n>..#\r\n")
    arena = load_arena(tmp_path / "mine.txt")
    assert arena == Arena([Wall((0.15, 0.025), (0.2, 0.025), 0.05)], start=(0.025, 0.025))


def test_a_map_has_its_origin_at_the_lower_left_and_its_first_row_on_top():
    arena = drawn("G..o", "S...")
    assert arena.start == (0.05, 0.05)
    assert arena.goal == Goal((0.05, 0.15))
    assert arena.cylinders == (Cylinder((0.35, 0.15), 0.025),)


@pytest.mark.parametrize(
    ("letter", "heading"), [("S", 0), (">", 0), ("^", 90), ("<", 180), ("v", -90)]
)
def test_the_letter_of_the_start_says_where_the_robot_faces(letter, heading):
    assert math.degrees(drawn(f"..{letter}").heading) == pytest.approx(heading)


def test_runs_of_a_wall_are_one_straight_wall():
    assert drawn("S.....", "......", "#####.").walls == (Wall((0.0, 0.05), (0.5, 0.05), 0.1),)
    assert drawn("S.#", "..#", "..#").walls == (Wall((0.25, 0.0), (0.25, 0.3), 0.1),)
    thick = drawn("......", "####..", "####..", ".....S")
    assert thick.walls == (Wall((0.0, 0.2), (0.4, 0.2), 0.2),)


def test_a_box_is_four_walls_that_overlap_at_its_corners():
    arena = drawn("#####", "#...#", "#.S.#", "#...#", "#####")
    assert len(arena.walls) == 4
    assert {wall.length for wall in arena.walls} == {0.5}
    assert arena.clearance(*arena.start) == pytest.approx(0.15)


def test_a_diagonal_is_one_slanted_wall_from_corner_to_corner():
    (rising,) = drawn("S..#", "..#.", ".#..").walls
    assert rising.start == (0.1, 0.0)
    assert rising.end == (0.4, 0.3)
    assert rising.thickness == pytest.approx(0.1 / math.sqrt(2))
    (falling,) = drawn("#...", ".#..", "..#S").walls
    assert (falling.start, falling.end) == ((0.0, 0.3), (0.3, 0.0))


SQUARES = st.lists(st.text(".#", min_size=8, max_size=8), min_size=1, max_size=8)


@given(SQUARES)
def test_walls_cover_every_square_and_no_floor_but_beside_slanted_ones(rows):
    try:
        arena = drawn("S" + "." * 8, "." * 9, *rows)
    except DesignError:  # a rounded end of a wall at the start
        assume(False)
        raise
    high = len(rows)
    for j, row in enumerate(rows):
        for i, letter in enumerate(row):
            x, y = 0.1 * i + 0.05, 0.1 * (high - 1 - j) + 0.05
            inside = any(covers(wall, x, y) for wall in arena.walls)
            assert inside == (letter == "#")


def covers(wall: Wall, x: float, y: float) -> bool:
    """Whether a point lies in the rectangle of a wall."""
    along = ((x - wall.start[0]) * (wall.end[0] - wall.start[0])
             + (y - wall.start[1]) * (wall.end[1] - wall.start[1])) / wall.length  # fmt: skip
    across = ((x - wall.start[0]) * (wall.end[1] - wall.start[1])
              - (y - wall.start[1]) * (wall.end[0] - wall.start[0])) / wall.length  # fmt: skip
    return 0 < along < wall.length and abs(across) < wall.thickness / 2


coordinate = st.floats(-5, 5).filter(lambda v: v == 0 or abs(v) > 1e-9)
points = st.tuples(coordinate, coordinate)
text = st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=9)


level, some = st.floats(-0.01, 0.01), st.floats(0.01, 2)
PATCHES = st.builds(Patch, points, points, level, st.none() | some, st.none() | some)
PLATES = st.builds(
    Plate, points, st.tuples(some, some), st.floats(1e-4, 0.01), some, some, st.floats(-7, 7)
)


@st.composite
def any_arena(draw) -> Arena:
    size = st.floats(1e-3, 0.5)
    try:
        return Arena(
            draw(st.lists(st.builds(Wall, points, points, size), max_size=3)),
            draw(st.lists(st.builds(Cylinder, points, size), max_size=3)),
            draw(points),
            draw(st.floats(-7, 7)),
            draw(st.none() | st.builds(Goal, points, size)),
            draw(text),
            slope=draw(st.none() | st.builds(Slope, st.floats(-0.78, 0.78), st.floats(-7, 7))),
            patches=draw(st.lists(PATCHES, max_size=2)),
            plates=draw(st.lists(PLATES, max_size=2)),
        )
    except ValueError:  # a wall without length, a start inside something
        assume(False)
        raise


@given(any_arena())
def test_an_arena_survives_its_file_to_the_last_bit(arena):
    assert loads_arena(dumps(arena)) == arena
    assert dumps(loads_arena(dumps(arena))) == dumps(arena)


def test_save_writes_what_load_arena_reads(tmp_path):
    arena = load_arena("pen")
    save(arena, tmp_path / "pen.toml")
    assert load_arena(tmp_path / "pen.toml") == arena
    with refuses(ValueError, ".toml"):
        save(arena, tmp_path / "pen.txt")
    assert [file.name for file in tmp_path.iterdir()] == ["pen.toml"]


@pytest.mark.parametrize("name", NAMES)
def test_every_arena_of_the_package_loads_has_a_title_and_room_to_start(name):
    arena = load_arena(name)
    assert arena.title == arenas()[name]
    assert arena.title
    assert arena.clearance(*arena.start) >= 0.25
    assert loads_arena(arena_text(name)) == arena


def test_the_arenas_are_what_their_names_promise():
    others = {"wall-ahead", "long-wall", "corner", "bend-left", "bend-right"}
    assert set(NAMES) - others == {"open", "wall", "cylinder", "three-walls", "corridor", "pen"}
    nothing = load_arena("open")
    assert (nothing.walls, nothing.cylinders) == ((), ())
    (wall,) = load_arena("wall").walls
    assert math.degrees(wall.angle) == pytest.approx(45)
    (cylinder,) = load_arena("cylinder").cylinders
    assert cylinder == Cylinder((0.32, 0.04), 0.025)
    corner = load_arena("corner").walls
    assert math.degrees(corner[0].angle - corner[1].angle) % 180 == pytest.approx(90)
    left, right = load_arena("bend-left"), load_arena("bend-right")
    # Mirror images; the width is that between the walls' faces.
    assert [one.start for one in left.walls] == [(x, -y) for x, y in (w.start for w in right.walls)]
    assert left.walls[2].start[1] - left.walls[0].start[1] == pytest.approx(0.6 + 0.02)
    assert left.walls[1].start[0] - left.walls[3].start[0] == pytest.approx(0.6 + 0.02)
    three, corridor = load_arena("three-walls"), load_arena("corridor")
    assert len(three.walls) == 3
    assert corridor.walls[:3] == three.walls
    assert corridor.goal == three.goal is not None
    low, high = corridor.walls[3:]
    assert 1.6 <= abs(high.start[1] - low.start[1]) <= 2.0
    pen = load_arena("pen")
    spans = {round(wall.length - 2 * wall.thickness, 9) for wall in pen.walls}
    assert spans == {1.2}


def test_walls_of_an_obstacle_course_leave_gaps_of_035_m():
    corridor = load_arena("corridor")
    for i, wall in enumerate(corridor.walls[:3]):
        others = Arena([w for k, w in enumerate(corridor.walls) if k != i], start=(-9.0, 0.0))
        ends = (wall.start, wall.end)
        assert min(others.clearance(*end) for end in ends) - wall.thickness / 2 >= 0.35


def test_a_wrong_name_is_answered_with_the_nearest():
    with pytest.raises(DesignError) as caught:
        load_arena("three-wals")
    says(str(caught.value), "three-wals: no such", ".toml", ".txt", "Did you mean", "three-walls?")
    with refuses(DesignError, "penn: ", "no such arena", "Did you mean", "pen?"):
        arena_text("penn")
    with refuses(DesignError, "maze.toml: ", "no such file"):
        load_arena("maze.toml")


GROUND = """
[slope]
angle_deg = 5
uphill_deg = 90
[[patch]]
from_mm = [100, -500]
to_mm = [90, 500]
level_mm = -2
[[patch]]
from_mm = [200, 0]
to_mm = [300, 500]
foot_friction = 0.1
drag_N = 0.8
[[plate]]
at_mm = [150, 60]
size_mm = [60, 40]
thickness_mm = 0.1
mass_g = 2
friction = 0.3
heading_deg = 180
"""


def test_the_ground_is_read_in_its_units():
    arena = loads_arena(GROUND)
    assert arena.slope == Slope(math.radians(5), math.radians(90))
    groove, ice = arena.patches
    assert groove == Patch((0.1, -0.5), (0.09, 0.5), level=-0.002)
    assert ice == Patch((0.2, 0.0), (0.3, 0.5), foot_friction=0.1, drag=0.8)
    assert arena.plates == (Plate((0.15, 0.06), (0.06, 0.04), 1e-4, 0.002, 0.3, math.pi),)


@pytest.mark.parametrize(
    ("text", "says_"),
    [
        ("[slope]\nangle_deg = 50", "slope.angle_deg = 50: must be from -45 to 45"),
        ("[slope]", "slope.angle_deg: is missing"),
        ("[[patch]]\nfrom_mm = [0, 0]\nto_mm = [0, 9]", "patch[0]: start"),
        ("[[patch]]\nfrom_mm = [0, 0]\nto_mm = [9, 9]\nlevel_mm = 11", "from -10 to 10"),
        ("[[patch]]\nfrom_mm = [0, 0]\nto_mm = [9, 9]\nfoot_friction = 0", "foot_friction = 0"),
        ("[[patch]]\nfrom_mm = [0, 0]\nto_mm = [9, 9]\ndrag_N = -1", "drag_N = -1"),
        ("[[patch]]\nfrom_mm = [0, 0]\nto_mm = [9, 9]\nlevl_mm = 1", "Did you mean level_mm?"),
        (
            "[[patch]]\nfrom_mm = [0, 0]\nto_mm = [9, 9]\n[[patch]]\nfrom_mm = [8, 8]\n"
            "to_mm = [99, 99]",
            "patch[0] and patch[1] overlap",
        ),
        ("[[plate]]\nat_mm = [0, 0]", "plate[0].size_mm: is missing"),
        (
            "[[plate]]\nat_mm = [0, 0]\nsize_mm = [0, 9]\nthickness_mm = 1\nmass_g = 1",
            "size[0] = 0.0 m: must be > 0",
        ),
        (
            "[[plate]]\nat_mm = [0, 0]\nsize_mm = [9, 9]\nthickness_mm = 20\nmass_g = 1",
            "thickness_mm = 20",
        ),
    ],
)
def test_an_impossible_ground_is_refused_with_its_key(text, says_):
    assert says_ in answer(text)


def test_numbers_of_an_arena_are_varied_by_their_keys():
    arena = loads_arena(GROUND)
    varied = vary_arena(
        arena, {"slope.angle_deg": 7, "patch[0].level_mm": 1, "patch[0].foot_friction": 0.4}
    )
    assert varied.slope == Slope(math.radians(7), math.radians(90))
    assert varied.patches[0] == Patch((0.1, -0.5), (0.09, 0.5), 0.001, foot_friction=0.4)
    assert varied.patches[1:] == arena.patches[1:]
    assert vary_arena(Arena(), {"slope.angle_deg": 3}).slope == Slope(math.radians(3))
    assert vary_arena(arena, {"start_seed": 4}) == other_start(arena, 4)
    with refuses(DesignError, "this arena's", "Did you mean", "slope.angle_deg?"):
        vary_arena(arena, {"slop.angle_deg": 3})
    with refuses(DesignError, "start_mm", "is a list", "start_mm[0]"):
        vary_arena(arena, {"start_mm": 3})
    with refuses(DesignError, "patch[0].level_mm = 30"):
        vary_arena(arena, {"patch[0].level_mm": 30})
    with refuses(DesignError, "start_seed = 0.5"):
        vary_arena(arena, {"start_seed": 0.5})
