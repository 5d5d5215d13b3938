"""What a study computes of every design: its columns, and the function that fills a row."""

import hashlib
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from stepwell.base import InputError, nearest_word
from stepwell.mechanism import Chain
from stepwell.robot import Robot
from stepwell.studies.designs import Block, Subject

Row = Mapping[str, Any]
TEXT = "text"
ENGINES = CPU, WARP = ("cpu", "warp")
# What a screened study has besides: the screen's verdict; whether the row was computed; whether it
# is one of those that are computed in any case, one of `ONE_OF` by lot.
SCREENED, ONE_OF = "screened", 10
SCREEN_COLUMNS = {SCREENED: TEXT, "again": "1", "lot": "1"}
RobotParameter = Mapping[str, Any]


class Screen(NamedTuple):
    """What looks at many designs at once beforehand, and leaves to `Work.row` those worth it."""

    verdicts: Callable[[Sequence[Any]], list[str]]  # of designs, "" where nothing can be told
    verdict: Callable[[Row], str]  # the same of a row that was computed
    kept: Callable[[str], bool]  # whether a design of this verdict is worth it
    aim: Callable[[str], Any]  # what `kept` wants, by the verdict of the design that is varied


class Work(NamedTuple):
    """What is computed."""

    columns: Mapping[str, str]  # unit by name; `TEXT` for words, "1" for ratios and counts
    row: Callable[[Any, int], Row]  # the values of a design, from the design and its own seed
    screen: Screen | None = None  # what chooses the designs that are computed, else all


def work_of(what: str, given: RobotParameter, subject: Subject) -> Work:
    """What is computed under a name, one of `WORKS`, of a design; "atlas" takes blocks of designs.

    Besides the design there is `given` by name: of a program `start` and `target`; of a walk
    `cycles`; of a maze `arena` (the text of its file), `limit` [s], `layouts`, the `first` of them,
    and the largest `place` [m] and `angle` [rad] by which their walls differ; of both `engine`
    ("cpu", or "warp" to screen them) and what is `wanted` of those kept; of a call what
    `function_of` gives. A `ValueError` refuses other names, kinds of design and what is not taken.
    """
    if what not in WORKS:
        near = nearest_word(what, WORKS)
        meant = f" Did you mean {near}?" if near else ""
        raise InputError(f"what = {what!r}: must be one of {', '.join(WORKS)}.{meant}")
    kind, make = WORKS[what]
    if not isinstance(subject, kind):
        wanted = "a robot" if kind is Robot else "a chain"
        raise InputError(f"{what}: takes {wanted}, and this design is none.")
    parameters = inspect.signature(make).parameters.keys()
    takes = parameters - {"subject"}
    if unknown := given.keys() - takes:
        raise InputError(
            f"{what}: takes {', '.join(sorted(takes)) or 'nothing else'}, not "
            f"{', '.join(sorted(unknown))}."
        )
    if "subject" in parameters:
        make = partial(make, subject)
    try:
        return make(**given)
    except TypeError as error:
        raise InputError(f"{what}: {error}.") from None


def _filled(columns: Mapping[str, str], values: Callable[[Any, int], Sequence[Any]]) -> Work:
    """Work whose rows are the values of its columns in their order."""
    return Work(columns, lambda design, seed: dict(zip(columns, values(design, seed), strict=True)))


def _cycle() -> Work:
    from stepwell.sequences import cycle

    def values(chain: Chain, _seed: int) -> Sequence[Any]:
        found = cycle(chain)
        # Of two forces of one size either way, rounding would choose the sign.
        peak = abs(found.peak_force)
        return str(found.sequence), len(found.snaps), peak, found.dissipated, len(found.degenerate)

    columns = {"sequence": TEXT, "snaps": "1", "peak_force": "N", "dissipated": "J", "ties": "1"}
    return _filled(columns, values)


def _margin() -> Work:
    from stepwell.design import margin
    from stepwell.sequences import cycle

    def values(chain: Chain, _seed: int) -> Sequence[Any]:
        found = margin(chain)
        least = (float(one.min(initial=math.inf)) for one in (found.anchors, found.stiffness))
        return str(cycle(chain).sequence), *least

    return _filled({"sequence": TEXT, "anchor": "m", "stiffness": "1"}, values)


def _yield() -> Work:
    from stepwell.design import yields

    def values(chain: Chain, seed: int) -> Sequence[Any]:
        found = yields(chain, seed=seed)
        return found.target, found.share, *found.interval

    return _filled({"sequence": TEXT, "share": "1", "share_low": "1", "share_high": "1"}, values)


def _graph() -> Work:
    def values(chain: Chain, _seed: int) -> Sequence[Any]:
        graph = chain.graph()
        return len(graph), graph.transition_count

    return _filled({"states": "1", "transitions": "1"}, values)


def _program(subject: Chain, start: str | None = None, target: str | None = None) -> Work:
    from stepwell.sequences import Unreachable

    if target is None:
        raise InputError("program: target: must be a state, such as 01.")
    unit = subject.drive_unit

    def values(chain: Chain, _seed: int) -> Sequence[Any]:
        try:
            found = chain.program(target, start=start)
        except Unreachable as why:
            return 0, why.proved, math.nan, math.nan, math.nan
        return 1, found.shortest, found.strokes, found.slack, found.end

    columns = {"found": "1", "proved": "1", "strokes": "1", "slack": unit, "end": unit}
    return _filled(columns, values)


def _walk(cycles: int = 4, engine: str = "cpu", wanted: str = "") -> Work:
    from stepwell.simulation import Trial, walk

    if not 1 <= cycles <= 1000:
        raise InputError(f"walk: cycles = {cycles}: must be from 1 to 1000.")

    def row(robot: Robot, _seed: int) -> Row:
        return told(Trial.of(walk(robot, cycles)))

    def told(found: Trial) -> Row:
        gaits = " | ".join(gait or "none" for gait in found.gaits)
        numbers = {name: getattr(found, name) for name in ("advance", "sideways", "turn", "work")}
        return {**numbers, "gaits": gaits, "stopped": found.stopped}

    def verdict(found: Row) -> str:
        return "stopped" if found["stopped"] else str(found["gaits"])

    def verdicts(robots: Sequence[Robot]) -> list[str]:
        from stepwell.simulation import screen_walks

        trials = screen_walks(robots, cycles=cycles)
        return ["" if trial is None else verdict(told(trial)) for trial in trials]

    numbers = {"advance": "1", "sideways": "1", "turn": "rad", "work": "J"}

    def aim(told: str) -> str:
        if told == "stopped":
            raise InputError("the design itself stops early, so no other can keep its gait.")
        return told

    screen = Screen(verdicts, verdict, lambda told: told == wanted, aim)
    return Work({**numbers, "gaits": TEXT, "stopped": TEXT}, row, _with(engine, screen))


def _with(engine: str, screen: Screen) -> Screen | None:
    """What an engine screens by."""
    if engine not in ENGINES:
        raise InputError(f"engine = {engine!r}: must be one of {', '.join(ENGINES)}.")
    return screen if engine == WARP else None


def _maze(
    arena: str = "",
    limit: float = 600.0,
    layouts: int = 0,
    first: int = 0,
    engine: str = "cpu",
    wanted: int = 0,
    place: float | None = None,
    angle: float | None = None,
) -> Work:
    from stepwell.files import loads_arena
    from stepwell.robot import other_layout, other_start
    from stepwell.simulation import Outcome, maze

    if not arena:
        raise InputError("maze: arena: must be the text of an arena's file.")
    if not limit > 0:
        raise InputError(f"maze: limit = {limit} s: must be > 0.")
    if not 0 <= layouts <= 10_000:
        raise InputError(f"maze: layouts = {layouts}: must be from 0 to 10000.")
    if not 0 <= first <= 2**31:
        raise InputError(f"maze: first = {first}: must be from 0 to 2147483648.")
    spread = {"place": place, "angle": angle}
    most = {name: value for name, value in spread.items() if value is not None}
    for name, value in most.items():
        if not 0 <= value < math.inf:
            raise InputError(f"maze: {name} = {value}: must be >= 0.")
    if most and not layouts:
        raise InputError(f"maze: {', '.join(most)}: is of layouts, and layouts = 0.")
    loaded = loads_arena(arena, "arena")
    # The same for every design, so that what differs is the design.
    seeds = range(first, first + layouts)
    moved = [other_start(other_layout(loaded, seed, **most), seed) for seed in seeds]
    places = moved or [loaded]

    def row(robot: Robot, _seed: int) -> Row:
        ways = [maze(robot, one, limit=limit) for one in places]
        there = [way for way in ways if way.outcome is Outcome.REACHED]
        times = [float(way.walk.time[-1]) for way in there]
        return {
            "reached": len(there) / len(ways),
            "time": sum(times) / len(times) if times else math.nan,
            "outcomes": told([way.outcome for way in ways]),
        }

    def told(outcomes: Sequence[Outcome]) -> str:
        return ", ".join(outcome.name.lower().replace("_", " ") for outcome in outcomes)

    def verdicts(robots: Sequence[Robot]) -> list[str]:
        from stepwell.simulation import screen_mazes

        entries = [(robot, one) for robot in robots for one in places]
        ends, n = screen_mazes(entries, limit=limit), len(places)
        of_each = ([e for e in ends[k : k + n] if e is not None] for k in range(0, len(ends), n))
        return [told(ways) if len(ways) == n else "" for ways in of_each]

    def reached(told: str) -> int:
        return told.split(", ").count("reached")

    def aim(told: str) -> int:
        if not reached(told):
            raise InputError("the design itself reaches no goal, so every other does as well.")
        return reached(told)

    screen = Screen(
        verdicts, lambda found: str(found["outcomes"]), lambda told: reached(told) >= wanted, aim
    )
    columns = {"reached": "1", "time": "s", "outcomes": TEXT}
    return Work(columns, row, _with(engine, screen))


def _atlas(subject: Chain, drive: str = "stroke") -> Work:
    from stepwell.studies.blocks import COUNTS, DRIVES, block_row, packed

    if drive not in DRIVES:
        raise InputError(f"atlas: drive = {drive!r}: must be one of {', '.join(DRIVES)}.")

    def row(block: Any, _seed: int) -> Row:
        if not isinstance(block, Block):
            raise InputError("atlas: takes blocks of designs.")
        names = block.space.names(subject)
        return block_row(block, packed(subject, names), DRIVES[drive])

    return Work({**dict.fromkeys(COUNTS, "1"), "graphs": TEXT, "cycles": TEXT, "asked": TEXT}, row)


def _call(
    subject: Subject,
    file: str = "",
    name: str = "",
    sha256: str = "",
    units: RobotParameter | None = None,
) -> Work:
    function, digest = _loaded(file, name)
    if digest != sha256:
        raise InputError(f"{file}: is not the file that the study was begun with (SHA-256).")
    if units is None:
        raise InputError("call: units: must name what the function gives.")
    return Work(dict(units), function)


def function_of(where: str, subject: Subject) -> dict[str, Any]:
    """What a study takes to call a function of one's own, FILE.py:NAME, on every design.

    The function takes a design and a seed, and gives a number or a text by name, the same ones for
    every design. It is called once, on the design as it is. An attribute `units` of it may give SI
    units by name. The file is found again by whoever fills the study. A `ValueError` refuses what
    is no such file or function, or gives no mapping of numbers and texts.
    """
    file, _, name = where.rpartition(":")
    path = str(Path(file).resolve())
    function, digest = _loaded(path, name)
    found = function(subject, 0)
    if not isinstance(found, Mapping) or not found:
        raise InputError(f"{where}: gave {found!r}: must give values by name, as in {{'x': 1.0}}.")
    told = getattr(function, "units", {})
    units = {}
    for key, value in found.items():
        if not (
            isinstance(key, str) and key.isidentifier() and isinstance(value, str | float | int)
        ):
            raise InputError(f"{where}: {key!r} = {value!r}: must be a number or a text by a name.")
        units[key] = TEXT if isinstance(value, str) else str(told.get(key, "1"))
    return {"file": path, "name": name, "sha256": digest, "units": units}


def _loaded(file: str, name: str) -> tuple[Any, str]:
    path = Path(file)
    if not name or path.suffix != ".py" or not path.is_file():
        raise InputError(f"function {file}:{name}: must be FILE.py:NAME, and the file there.")
    source = path.read_bytes()
    digest = hashlib.sha256(source).hexdigest()
    # What runs is what was hashed, and nothing is left beside the file.
    module = ModuleType(f"stepwell_call_{digest[:12]}")
    module.__file__ = str(path)
    try:
        exec(compile(source, path, "exec"), module.__dict__)
    except Exception as error:
        told = f"{type(error).__name__}: {error}"
        raise InputError(f"function {file}:{name}: the file cannot be run: {told}.") from None
    function: Any = getattr(module, name, None)
    if not callable(function):
        raise InputError(f"function {file}:{name}: the file has no function of that name.")
    return function, digest


WORKS: dict[str, tuple[Any, Callable[..., Work]]] = {
    "cycle": (Chain, _cycle),
    "margin": (Chain, _margin),
    "yield": (Chain, _yield),
    "graph": (Chain, _graph),
    "program": (Chain, _program),
    "walk": (Robot, _walk),
    "maze": (Robot, _maze),
    "atlas": (Chain, _atlas),
    "call": (Subject, _call),
}
