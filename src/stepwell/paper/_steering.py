"""Claims about antennas, walls and mazes, each found by many simulated runs."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from stepwell import files
from stepwell.paper._robot import robot, simulated
from stepwell.paper.claim import Claim, Finding, judged
from stepwell.robot import Arena, Cylinder, Robot, Wall, other_layout, other_start

if TYPE_CHECKING:
    from stepwell.physics import Maze

# Declared before any of these runs.
STARTS = tuple(range(100, 110))
LAYOUTS = tuple(range(200, 210))
FIELDS = tuple(range(500, 512))
GAP = 0.35  # between the walls of a field, and between them and the start [m]
WALLS_DEG = (15, 23, 31, 39, 47, 55, 63, 72, 80)
BETWEEN_DEG = (19, 27, 35, 43, 51, 59, 67.5, 76, 84)
OFFSETS_MM = (-100, -75, -50, -25, -10, 15, 40, 65, 90)
OTHER_OFFSETS_MM = (-90, -65, -40, -15, 10, 25, 50, 75, 100)
HEAD_ON_DEG = (88, 88.5, 89, 89.5, 90, 90.5, 91, 91.5, 92)

FORWARD = "00>10>11>01>00"
BACKWARD = "00>01>11>10>00"


def wall_ahead(angle: float, clear: float = 0.28) -> Arena:
    """A flat wall that the robot meets at an angle [rad] after a free way.

    Args:
        angle: between heading and wall [rad]; negative for its mirror image.
        clear: distance of the start from the wall [m].
    """
    ahead = clear / math.sin(abs(angle))
    x, y = 0.9 * math.cos(angle), 0.9 * math.sin(angle)
    return Arena([Wall((ahead - x, -y), (ahead + x, y))], title=f"Wall at {math.degrees(angle):g}°")


def cylinder_ahead(offset: float) -> Arena:
    """A cylinder of 50 mm across, 360 mm ahead and `offset` [m] to the left of the heading."""
    return Arena((), [Cylinder((0.36, offset))], title=f"Cylinder {offset * 1e3:g} mm off")


@cache
def _presses(name: str) -> dict[str, tuple[str, ...]]:
    """Gaits of the third cycle, antennas free and the left one held at full swing."""
    from stepwell.physics import walk

    design = robot(name)
    gaits: dict[str, tuple[str, ...]] = {}
    for label, held in (("free", {}), ("pressed", {"left": design.antennas[0].swing})):
        found = walk(design.pressed(held), 3).gaits
        gaits[label] = tuple(each[-1] for each in found.values())
    return gaits


def _papers_antennas() -> Finding:
    gaits = _presses("antennas")
    flips = gaits["free"] == (FORWARD, FORWARD) and gaits["pressed"] == (FORWARD, BACKWARD)
    largest, least = _nearest()
    depths = ", ".join(f"{q:g} mm with the feet {below:g} mm deep" for below, q in largest.items())
    return judged(
        flips,
        f"free {gaits['free'][1]}, pressed {gaits['pressed'][1]}",
        otherwise=f"At q_out = 20 mm an inner anchor at -11 mm does not turn the step round. With "
        f"the other numbers as given it does for q_out up to {depths}. At 14 mm and 0.3 mm it "
        f"takes {least:g} mm of anchor displacement; `robot-explorer` has these and moves its "
        f"anchor by up to 10 mm.",
    )


@cache
def _nearest() -> tuple[dict[float, float], float]:
    """Largest q_out [mm] that 4 mm of anchor flip, by depth [mm]; what flips 14 mm [mm]."""
    from stepwell.physics import sweep

    base = robot("antennas")
    depths, outer = (0.1, 0.3, 0.6, 1.0), [float(q) for q in range(11, 21)]
    moves = [m / 10 for m in range(20, 61, 2)]

    def variant(below: float, q: float, moved: float) -> Robot:
        design = replace(base, foot=replace(base.foot, below=below * 1e-3))
        for leg in ("left", "right"):
            design = design.with_anchors(leg, "outer", q=(q * 1e-3, 0.0))
            design = design.with_anchors(leg, "inner", p=((-7.0 - moved) * 1e-3, 0.0))
        return design

    robots = [variant(b, q, m) for b in depths for q in outer for m in (0.0, 4.0)]
    gaits = iter([trial.gaits[0] for trial in sweep(robots, cycles=3).trials])
    largest: dict[float, float] = {}
    for below in depths:
        for q in outer:
            if (next(gaits), next(gaits)) == (FORWARD, BACKWARD):
                largest[below] = q
    pressed = sweep([variant(0.3, 14.0, moved) for moved in moves], cycles=3).trials
    enough = [m for m, t in zip(moves, pressed, strict=True) if t.gaits[0] == BACKWARD]
    return largest, min(enough, default=math.nan)


def _turns_away() -> Finding:
    gaits = _presses("explorer")
    agrees = gaits == {"free": (FORWARD, FORWARD), "pressed": (FORWARD, BACKWARD)}
    return judged(
        agrees,
        f"right leg: free {gaits['free'][1]}, left antenna pressed {gaits['pressed'][1]}",
        note="With our design `robot-explorer`: q_out = 14 mm, feet 0.3 mm deep, 10 mm of anchor "
        "displacement at full swing.",
        otherwise="Our design does not do it either.",
    )


def _avoided(arenas: tuple[Arena, ...], limit: float) -> tuple[int, list[str]]:
    """How many of these the robot leaves behind, and which not."""
    from stepwell.physics import mazes

    design = robot("explorer")
    ways = mazes([(design, arena) for arena in arenas], limit=limit)
    missed = [way.arena.title for way in ways if not way.walks_on]
    return len(ways) - len(missed), missed


def _obstacles(sets: tuple[tuple[Arena, ...], ...], limit: float) -> Finding:
    counts, all_missed = [], []
    for arenas in sets:
        count, missed = _avoided(arenas, limit)
        counts.append(f"{count} of {len(arenas)}")
        all_missed += missed
    agrees = all(int(c.split()[0]) >= int(c.split()[2]) - 1 for c in counts)
    return judged(
        agrees,
        ", ".join(counts),
        note="Two sets, the second chosen before it was run. "
        + (f"Not avoided: {'; '.join(all_missed)}." if all_missed else "All avoided."),
        otherwise=f"Not avoided: {'; '.join(all_missed)}.",
    )


def _walls() -> Finding:
    first = tuple(wall_ahead(math.radians(angle)) for angle in WALLS_DEG)
    second = tuple(wall_ahead(-math.radians(angle)) for angle in BETWEEN_DEG)
    return _obstacles((first, second), 200.0)


def _cylinders() -> Finding:
    sets = (OFFSETS_MM, OTHER_OFFSETS_MM)
    return _obstacles(tuple(tuple(cylinder_ahead(mm / 1e3) for mm in each) for each in sets), 160.0)


def _head_on() -> Finding:
    from stepwell.physics import mazes

    even = robot("explorer").with_anchors("right", "inner", p=(-0.007, 0.0))
    arenas = [wall_ahead(math.radians(angle)) for angle in HEAD_ON_DEG]
    counts = []
    for design in (robot("explorer"), even):
        ways = mazes([(design, arena) for arena in arenas], limit=200.0)
        counts.append(sum(way.walks_on for way in ways))
    return judged(
        counts[0] >= len(arenas) - 1,
        f"{counts[0]} of {len(arenas)}; {counts[1]} with equal antennas",
        note="The paper is silent. Met exactly head-on, both antennas are pressed alike, both legs "
        "step backward and the robot goes back and forth; one antenna that acts a little earlier "
        "breaks the tie, which moves the trap to another angle rather than removing it.",
        otherwise="Trapped by symmetry: both antennas are pressed alike.",
    )


def _crossed(ways: tuple[Maze, ...]) -> int:
    """How many reached the goal having touched the first three walls."""
    from stepwell.physics import Outcome

    walls = [f"wall {i + 1}" for i in range(3)]
    return sum(
        way.outcome is Outcome.REACHED and all(way.touched[wall] is not None for wall in walls)
        for way in ways
    )


@cache
def _from_starts(name: str, control: str) -> int:
    from stepwell.physics import mazes

    design, arena = robot("explorer"), files.load_arena(name)
    if control == "without antennas":
        design = replace(design, antennas=())
    elif control == "levers off":
        off = tuple(replace(antenna, connected=False) for antenna in design.antennas)
        design = replace(design, antennas=off)
    entries = [(design, other_start(arena, seed)) for seed in STARTS]
    return _crossed(mazes(entries, limit=700.0))


def _three_walls(name: str) -> Finding:
    counts = {label: _from_starts(name, label) for label in ("", "without antennas", "levers off")}
    whole = len(STARTS)
    return judged(
        counts[""] >= 9 and max(counts["without antennas"], counts["levers off"]) <= 1,
        f"{counts['']} of {whole}; {counts['without antennas']} without antennas, "
        f"{counts['levers off']} with their levers off",
        note=f"Starts ± 40 mm and ± 10°, seeds {STARTS[0]} to {STARTS[-1]}; all three walls "
        f"touched. It turns in steps of about 15° until it glides along the wall it has met, and "
        f"leaves it in the wall's direction: it does not bounce like a ray.",
        otherwise=f"Seeds {STARTS[0]} to {STARTS[-1]}.",
    )


def _layouts() -> Finding:
    from stepwell.physics import mazes

    arena, design = files.load_arena("three-walls"), robot("explorer")
    ways = mazes([(design, other_layout(arena, seed)) for seed in LAYOUTS], limit=700.0)
    count = _crossed(ways)
    return judged(
        count >= 8,
        f"{count} of {len(LAYOUTS)}",
        note=f"Walls moved by ± 40 mm and turned by ± 8°, seeds {LAYOUTS[0]} to {LAYOUTS[-1]}.",
        otherwise=f"Seeds {LAYOUTS[0]} to {LAYOUTS[-1]}.",
    )


def field(seed: int) -> Arena:
    """Five walls at random before the robot, with gaps of 0.35 m or more between them."""
    rng = np.random.default_rng(seed)
    start, walls = np.zeros((1, 2)), []
    points: list[np.ndarray] = [start]
    while len(walls) < 5:
        middle = rng.uniform((0.2, -0.9), (2.2, 0.9))
        angle, length = rng.uniform(0.0, math.pi), rng.uniform(0.3, 0.9)
        half = length / 2 * np.array([math.cos(angle), math.sin(angle)])
        wall = Wall(tuple(middle - half), tuple(middle + half))
        line = np.linspace(wall.start, wall.end, 60)
        gaps = [np.linalg.norm(line[:, None] - other, axis=2).min() for other in points]
        if min(gaps) >= GAP + wall.thickness:
            walls.append(wall)
            points.append(line)
    return Arena(walls, title=f"Field {seed}")


def _fields() -> Finding:
    from stepwell.physics import mazes

    ways = mazes([(robot("explorer"), field(seed)) for seed in FIELDS], limit=600.0)
    # Far outside the rectangle in which the walls stand.
    left = [way.walks_on and math.hypot(way.walk.x[-1] - 1.2, way.walk.y[-1]) > 1.8 for way in ways]
    touched = sum(any(time is not None for time in way.touched.values()) for way in ways)
    kept = ", ".join(str(seed) for seed, out in zip(FIELDS, left, strict=True) if not out)
    return judged(
        sum(left) >= len(left) - 1,
        f"{sum(left)} of {len(left)} left behind",
        note=f"Five walls each, gaps of {GAP} m or more, seeds {FIELDS[0]} to {FIELDS[-1]}, drawn "
        f"before any run; in {touched} of them it met a wall."
        + (f" Not left within 600 s: {kept}." if kept else ""),
        otherwise=f"Not left within 600 s: seeds {kept}.",
    )


def _linkages() -> Finding:
    from stepwell.physics import Linkage, Settings, walk

    worst, turned = 0.0, 0.0
    for name in ("forward", "backward", "left", "right", "15", "explorer"):
        rods = walk(robot(name), 4)
        hinges = walk(robot(name), 4, settings=Settings(linkage=Linkage.HINGES))
        worst = max(worst, float(np.abs(rods.advance[1:] - hinges.advance[1:]).max()))
        turned = max(turned, float(np.degrees(np.abs(rods.turn[1:] - hinges.turn[1:])).max()))
    return judged(
        worst <= 0.05 and turned <= 2.0,
        f"{worst:.3f} in d/u_max, {turned:.1f}° in turn",
        note="Six robots; every lever and link a hinged body against rods of fixed length.",
        otherwise="The two models differ by more.",
    )


CLAIMS = (
    Claim(
        "antennas-paper-numbers",
        "A contact that moves p_in from (-7, 0) to (-11, 0) mm turns that leg's step round.",
        "Fig. 4",
        f"free {FORWARD}, pressed {BACKWARD}",
        "the same states",
        simulated(_papers_antennas),
    ),
    Claim(
        "antennas-turn-away",
        "A contact reprograms the opposite leg, and released, the robot walks on.",
        "Fig. 4",
        f"free {FORWARD}, pressed {BACKWARD}",
        "the same states, of a design of ours",
        simulated(_turns_away),
    ),
)

MANY_RUNS = (
    Claim(
        "robot-linkage",
        "The fast model and one with every lever and link as a body agree.",
        "ours",
        "within 0.05 in d/u_max and 2° in turn",
        "that",
        simulated(_linkages),
    ),
    Claim(
        "antennas-walls",
        "It avoids a flat wall from many approach angles.",
        "Fig. 4",
        "avoided",
        "8 of 9 or better, in both sets",
        simulated(_walls),
    ),
    Claim(
        "antennas-cylinder",
        "It avoids a cylinder of 50 mm from many offsets.",
        "Fig. 4",
        "avoided",
        "8 of 9 or better, in both sets",
        simulated(_cylinders),
    ),
    Claim(
        "antennas-head-on",
        "It gets away from a wall met head-on (90° ± 2°).",
        "ours",
        "away",
        "8 of 9 or better",
        simulated(_head_on),
    ),
    Claim(
        "three-walls-open",
        "It finds its way past three walls, in the open.",
        "Fig. 4D",
        "traversed",
        "9 of 10 starts; 1 or none in either control",
        simulated(partial(_three_walls, "three-walls")),
    ),
    Claim(
        "three-walls-corridor",
        "It finds its way past three walls, between side walls.",
        "Fig. 4D",
        "traversed",
        "9 of 10 starts; 1 or none in either control",
        simulated(partial(_three_walls, "corridor")),
    ),
    Claim(
        "three-walls-layouts",
        "It does so when the walls stand differently.",
        "ours",
        "traversed",
        "8 of 10 layouts",
        simulated(_layouts),
    ),
    Claim(
        "antennas-fields",
        "Walls that stand at random are passed as well.",
        "ours",
        "passed",
        "11 of 12 fields",
        simulated(_fields),
    ),
)
