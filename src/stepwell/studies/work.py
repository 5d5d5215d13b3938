"""Quantities that a study can compute: columns, and the function that computes a row."""

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
# Further columns of a screened study: the screen's verdict; whether the row was computed; whether
# it belongs to the random sample, one of `ONE_OF`, that is always computed.
SCREENED, ONE_OF = "screened", 10
SCREEN_COLUMNS = {SCREENED: TEXT, "again": "1", "lot": "1"}
RobotParameter = Mapping[str, Any]


class Screen(NamedTuple):
    """A prefilter of many designs, which selects those that `Work.row` computes."""

    verdicts: Callable[[Sequence[Any]], list[str]]  # of designs, "" if undecided
    verdict: Callable[[Row], str]  # the verdict of a computed row
    kept: Callable[[str], bool]  # whether a design with this verdict is selected
    aim: Callable[[str], Any]  # the target of `kept`, from the verdict of the nominal design


class Work(NamedTuple):
    """Columns of a study, and the computation of a row."""

    columns: Mapping[str, str]  # unit by name; `TEXT` for texts, "1" for ratios and counts
    row: Callable[[Any, int], Row]  # the values of a design, from the design and its own seed
    screen: Screen | None = None  # selects the designs to compute; None: all


def work_of(what: str, given: RobotParameter, subject: Subject) -> Work:
    """The computation with a name in `WORKS`; "atlas" takes blocks of designs.

    Options `given` by name: for a program `start` and `target`; for a walk `cycles`; for a maze
    `arena` (the text of its file), `limit` [s], `layouts`, the `first` of them, and the largest
    `place` [m] and `angle` [rad] by which their walls differ; for both `engine` ("cpu", or "warp"
    for a screen) and `wanted`, the target of the screen; for a call the result of `function_of`.
    Other names, designs and options raise a `ValueError`.
    """
    if what not in WORKS:
        near = nearest_word(what, WORKS)
        meant = f" Did you mean {near}?" if near else ""
        raise InputError(f"what = {what!r}: must be one of {', '.join(WORKS)}.{meant}")
    kind, make = WORKS[what]
    if not isinstance(subject, kind):
        wanted = "a robot" if kind is Robot else "a chain"
        raise InputError(f"{what}: needs {wanted}, and this design is another type.")
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
    """Work whose function returns the values of a row in the order of the columns."""
    return Work(columns, lambda design, seed: dict(zip(columns, values(design, seed), strict=True)))


def _cycle() -> Work:
    from stepwell.sequences import cycle

    def values(chain: Chain, _seed: int) -> Sequence[Any]:
        result = cycle(chain)
        # Absolute, because for two equal extremes rounding would determine the sign.
        peak = abs(result.peak_force)
        return (
            str(result.sequence),
            len(result.snaps),
            peak,
            result.dissipated,
            len(result.degenerate),
        )

    columns = {"sequence": TEXT, "snaps": "1", "peak_force": "N", "dissipated": "J", "ties": "1"}
    return _filled(columns, values)


def _margin() -> Work:
    from stepwell.design import margin
    from stepwell.sequences import cycle

    def values(chain: Chain, _seed: int) -> Sequence[Any]:
        result = margin(chain)
        least = (float(one.min(initial=math.inf)) for one in (result.anchors, result.stiffness))
        return str(cycle(chain).sequence), *least

    return _filled({"sequence": TEXT, "anchor": "m", "stiffness": "1"}, values)


def _yield() -> Work:
    from stepwell.design import yields

    def values(chain: Chain, seed: int) -> Sequence[Any]:
        result = yields(chain, seed=seed)
        return result.target, result.fraction, *result.interval

    return _filled(
        {"sequence": TEXT, "fraction": "1", "fraction_low": "1", "fraction_high": "1"}, values
    )


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
            result = chain.program(target, start=start)
        except Unreachable as why:
            return 0, why.proved, math.nan, math.nan, math.nan
        return 1, result.shortest, result.strokes, result.slack, result.end

    columns = {"found": "1", "proved": "1", "strokes": "1", "slack": unit, "end": unit}
    return _filled(columns, values)


def _walk(cycles: int = 4, engine: str = "cpu", wanted: str = "") -> Work:
    from stepwell.simulation import Trial, walk

    if not 1 <= cycles <= 1000:
        raise InputError(f"walk: cycles = {cycles}: must be from 1 to 1000.")

    def row(robot: Robot, _seed: int) -> Row:
        return outcome_row(Trial.of(walk(robot, cycles)))

    def outcome_row(trial: Trial) -> Row:
        gaits = " | ".join(gait or "none" for gait in trial.gaits)
        numbers = {name: getattr(trial, name) for name in ("advance", "sideways", "turn", "work")}
        return {**numbers, "gaits": gaits, "stopped": trial.stopped}

    def verdict(row: Row) -> str:
        return "stopped" if row["stopped"] else str(row["gaits"])

    def verdicts(robots: Sequence[Robot]) -> list[str]:
        from stepwell.simulation import screen_walks

        trials = screen_walks(robots, cycles=cycles)
        return ["" if trial is None else verdict(outcome_row(trial)) for trial in trials]

    numbers = {"advance": "1", "sideways": "1", "turn": "rad", "work": "J"}

    def aim(verdict: str) -> str:
        if verdict == "stopped":
            raise InputError("the nominal design stops early: choose one that walks to the end.")
        return verdict

    screen = Screen(verdicts, verdict, lambda one: one == wanted, aim)
    return Work({**numbers, "gaits": TEXT, "stopped": TEXT}, row, _with(engine, screen))


def _with(engine: str, screen: Screen) -> Screen | None:
    """The screen, if the engine is "warp"."""
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
        raise InputError(f"maze: {', '.join(most)}: applies to layouts, and layouts = 0.")
    loaded = loads_arena(arena, "arena")
    # All designs have the same layouts.
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
            "outcomes": outcome_text([way.outcome for way in ways]),
        }

    def outcome_text(outcomes: Sequence[Outcome]) -> str:
        return ", ".join(outcome.name.lower().replace("_", " ") for outcome in outcomes)

    def verdicts(robots: Sequence[Robot]) -> list[str]:
        from stepwell.simulation import screen_mazes

        entries = [(robot, one) for robot in robots for one in places]
        ends, n = screen_mazes(entries, limit=limit), len(places)
        of_each = ([e for e in ends[k : k + n] if e is not None] for k in range(0, len(ends), n))
        return [outcome_text(ways) if len(ways) == n else "" for ways in of_each]

    def reached(outcomes: str) -> int:
        return outcomes.split(", ").count("reached")

    def aim(outcomes: str) -> int:
        if not reached(outcomes):
            raise InputError("the nominal design reaches no goal: choose another design or arena.")
        return reached(outcomes)

    screen = Screen(
        verdicts,
        lambda row: str(row["outcomes"]),
        lambda outcomes: reached(outcomes) >= wanted,
        aim,
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
        raise InputError(f"{file}: differs from the file with which the study started (SHA-256).")
    if units is None:
        raise InputError("call: units: must contain a unit for each value of the function.")
    return Work(dict(units), function)


def function_of(where: str, subject: Subject) -> dict[str, Any]:
    """Options of a study that calls a user's function, FILE.py:NAME, on every design.

    The function takes a design and a seed and returns numbers or texts by name, with the same names
    for every design. It is called once on the nominal design. Its attribute `units` may contain SI
    units by name. All workers need the file. A missing file or function, or another result, raises
    a `ValueError`.
    """
    file, _, name = where.rpartition(":")
    path = str(Path(file).resolve())
    function, digest = _loaded(path, name)
    result = function(subject, 0)
    if not isinstance(result, Mapping) or not result:
        raise InputError(
            f"{where}: returned {result!r}: must give values by name, as in {{'x': 1.0}}."
        )
    units_of = getattr(function, "units", {})
    units = {}
    for key, value in result.items():
        if not (
            isinstance(key, str) and key.isidentifier() and isinstance(value, str | float | int)
        ):
            raise InputError(f"{where}: {key!r} = {value!r}: must be a number or a text by a name.")
        units[key] = TEXT if isinstance(value, str) else str(units_of.get(key, "1"))
    return {"file": path, "name": name, "sha256": digest, "units": units}


def _loaded(file: str, name: str) -> tuple[Any, str]:
    path = Path(file)
    if not name or path.suffix != ".py" or not path.is_file():
        raise InputError(f"function {file}:{name}: must be FILE.py:NAME, and the file there.")
    source = path.read_bytes()
    digest = hashlib.sha256(source).hexdigest()
    # Exactly the hashed source runs, and no bytecode is written next to the file.
    module = ModuleType(f"stepwell_call_{digest[:12]}")
    module.__file__ = str(path)
    try:
        exec(compile(source, path, "exec"), module.__dict__)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise InputError(f"function {file}:{name}: the file cannot be run: {reason}.") from None
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
