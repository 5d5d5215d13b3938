"""Panels of robots: scene, prediction, simulation."""

from functools import partial
from typing import TYPE_CHECKING

from stepwell import accounts, base, files
from stepwell.robot import Arena
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import LONGEST_MESSAGE

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk

_MOST_CYCLES = 1000
_LONGEST = 3600.0  # s


def arena_of(ask: Ask) -> Arena | None:
    """The arena of a request, or None for a bare floor."""
    return files.loads_arena_tables(ask.table("arena")) if ask.has("arena") else None


def asked_run(design: PageDesign, ask: Ask, *, in_maze: bool) -> "partial[Walk | Maze]":
    """The requested simulation: a walk of `cycles`, or a maze with a time limit `limit_s`."""
    arena = arena_of(ask)
    if in_maze:
        how: dict[str, float] = {"limit": ask.number("limit_s", 1.0, _LONGEST, 600.0)}
    else:
        how = {"cycles": ask.number("cycles", 0.01, _MOST_CYCLES, 8.0)}
    ask.close()
    if in_maze and arena is None:
        raise base.InputError("ask.arena: is missing; a maze needs one, if only the open floor.")
    robot = design.robot
    # Imported late: errors in a robot's parameters are reported without a simulator too.
    from stepwell.simulation import maze, walk

    return partial(maze if in_maze else walk, robot, arena=arena, progress=ask.report, **how)


def answer_arenas(_design: PageDesign, ask: Ask) -> View:
    """The arenas of the package, each with its name and title."""
    ask.close()
    return View({"arenas": [{"name": n, "title": t} for n, t in files.arenas().items()]})


def answer_arena(_design: PageDesign, ask: Ask) -> View:
    """The tables of the arena of a `name` or a `text`; or the file of an `arena`."""
    if arena := arena_of(ask):
        ask.close()
        return View({"toml": files.dumps(arena)})
    if ask.has("name"):
        text = files.arena_text(ask.text("name", 200))
    else:
        text = ask.text("text", LONGEST_MESSAGE)
    ask.close()
    if not text.strip():
        raise base.InputError("ask.text: is empty; it must be an arena's file or a map of letters.")
    arena = files.loads_arena(text)
    return View({"arena": files.arena_tables(arena), "title": arena.title})


def answer_robot(design: PageDesign, ask: Ask) -> View:
    """Parts and lines of the robot, their poses, and the effect of its antennas."""
    arena = arena_of(ask)
    ask.close()
    robot = design.robot
    # Imported late: errors in a robot's parameters are reported without a simulator too.
    from stepwell.studio.scene import Scene

    scene = Scene(robot, arena)
    return View(scene.header(), scene.placed(scene.start))


def answer_predict(design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell robot show --json`, and the predicted motion in words."""
    ask.close()
    prediction = design.robot.predict()
    return View({"motion": prediction.motion.value, "record": accounts.account(prediction).record})


def answer_walk(design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell walk --json`, and every sample."""
    return _answer(asked_run(design, ask, in_maze=False), ask)


def answer_maze(design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell maze --json`, and every sample."""
    return _answer(asked_run(design, ask, in_maze=True), ask)


def _answer(run: "partial[Walk | Maze]", ask: Ask) -> View:
    from stepwell.simulation import Maze
    from stepwell.studio.scene import Live

    live = Live(run.args[0], run.keywords["arena"], ask)
    result = run(look=live.look)
    record = accounts.account(result).record
    if isinstance(result, Maze):
        return live.view(result.walk, record=record, outcome=result.ending)
    return live.view(result, record=record)


_SHARES = 0.8, 1.2


def answer_robot_numbers(design: PageDesign, ask: Ask) -> View:
    """All nonzero parameters with key, unit and a range of ±20 %."""
    ask.close()
    numbers = [
        {
            "key": one.path,
            "label": one.path,
            "unit": one.unit,
            "value": one.values[0],
            "range": sorted(float(f"{one.values[0] * share:.3g}") for share in _SHARES),
        }
        for one in files.parameters(design.robot)
        if one.values[0]
    ]
    return View({"parameters": numbers})
