"""Design, check and understand machines whose motion is programmed into their springs."""

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stepwell import (
        accounts,
        base,
        concave,
        figures,
        files,
        lab,
        mechanism,
        paper,
        reports,
        robot,
        sequences,
        simulation,
        statics,
        studies,
        studio,
    )
    from stepwell.base import InputError, Measure, StepwellError, __version__, bar
    from stepwell.build import build
    from stepwell.design import (
        AnchorBox,
        BandType,
        Check,
        Impossible,
        Margin,
        Tolerances,
        Yield,
        boundaries,
        check,
        design,
        margin,
        parameter_map,
        reprogram,
        robustness,
        survival,
        transition_map,
        yields,
    )
    from stepwell.files import load_arena, load_element, preset, presets, save
    from stepwell.mechanism import Band, Cell, Chain, Cubic, Element, Linear, Load, Table, elements
    from stepwell.robot import Arena, Robot
    from stepwell.sequences import Cycle, Pathway, Program, Sequence, TransitionGraph, Unreachable
    from stepwell.statics import Event, Path
    from stepwell.studies import sweep

# Packages are imported when a name is first used: `import stepwell` is fast.
_DOORS = {
    "base": ("InputError", "Measure", "StepwellError", "__version__", "bar"),
    "design": (
        "AnchorBox",
        "Check",
        "Impossible",
        "Margin",
        "BandType",
        "Tolerances",
        "Yield",
        "boundaries",
        "check",
        "margin",
        "parameter_map",
        "reprogram",
        "robustness",
        "survival",
        "transition_map",
        "yields",
    ),
    "files": ("load_arena", "load_element", "preset", "presets", "save"),
    "mechanism": (
        "Band",
        "Cell",
        "Chain",
        "Cubic",
        "Element",
        "Linear",
        "Load",
        "Table",
        "elements",
    ),
    "robot": ("Arena", "Robot"),
    "sequences": ("Cycle", "Pathway", "Program", "Sequence", "TransitionGraph", "Unreachable"),
    "statics": ("Event", "Path"),
    "studies": ("sweep",),
}

# `sw.figures.overview(cycle)` needs no import of its own; `sw.design` and `sw.build` can be called
# too. Kernels and commands are private.
_ROOMS = (
    *("accounts", "base", "build", "concave", "design", "figures", "files", "lab"),
    *("mechanism", "paper", "reports", "robot", "sequences", "simulation", "statics"),
    *("studies", "studio"),
)

__all__ = [
    "AnchorBox",
    "Arena",
    "Band",
    "Cell",
    "Chain",
    "Check",
    "Cubic",
    "Cycle",
    "Element",
    "Event",
    "Impossible",
    "InputError",
    "Linear",
    "Load",
    "Margin",
    "Measure",
    "Path",
    "Pathway",
    "Program",
    "Robot",
    "Sequence",
    "StepwellError",
    "BandType",
    "Table",
    "Tolerances",
    "TransitionGraph",
    "Unreachable",
    "Yield",
    "__version__",
    "bar",
    "boundaries",
    "build",
    "check",
    "design",
    "elements",
    "load",
    "load_arena",
    "load_element",
    "make_env",
    "margin",
    "parameter_map",
    "preset",
    "presets",
    "reprogram",
    "robustness",
    "save",
    "survival",
    "sweep",
    "transition_map",
    "yields",
]


# A union would make every caller narrow the type; `stepwell.files.load` is typed.
def load(design: str | os.PathLike[str]) -> Any:
    """Load the chain, the hopper or the robot of a design file, in SI.

    Args:
        design: a TOML file, whose keys docs/design-files.md lists; or "preset:" and a name that
            `presets` lists, for example "preset:paper-forward".

    Returns:
        A Chain, a Hopper if the file has [hopper], or a Robot if it has [[leg]];
        `stepwell.files.load` also returns the text and the program.

    Raises:
        DesignError: the file is missing, is not text or TOML, or describes an impossible
            mechanism; its text has one line for every problem.
    """
    from stepwell import files

    return files.load(design).value


# Here, because robots and arenas by name are read by a package above the simulation.
def make_env(
    robot: Any, arena: Any = None, *, render_mode: str | None = None, **episode: Any
) -> Any:
    """A robot in an arena as an environment of Gymnasium, whose action is the stroke.

    Args:
        robot: a Robot, the name of a preset such as "robot-antennas", or a design file.
        arena: an Arena, the name of one such as "three-walls", or a file; a bare floor by default.
        render_mode: "rgb_array" for pictures by `render`, None for none.
        episode: reward, interval, limit, random_start, size and settings, as in
            `stepwell.simulation.Episode`.

    Returns:
        A `stepwell.simulation.RobotEnv` with the usual wrappers of Gymnasium.

    Raises:
        ValueError: the robot or the arena cannot be read, or an option is out of range.
        ExtraError: Gymnasium or MuJoCo is not installed.
    """
    from stepwell import files, simulation
    from stepwell.robot import Arena, Robot

    if not isinstance(robot, Robot):
        named = robot in files.presets() and not os.path.exists(robot)
        robot = files.load(f"preset:{robot}" if named else robot).robot
    if arena is not None and not isinstance(arena, Arena):
        arena = files.load_arena(arena)
    return simulation.make_env(robot, arena, render_mode=render_mode, **episode)


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        # The package itself: after its import, Python keeps it under this name.
        return import_module(f"stepwell.{name}")
    for room, names in _DOORS.items():
        if name in names:
            return getattr(import_module(f"stepwell.{room}"), name)
    raise AttributeError(f"module 'stepwell' has no attribute {name!r}")


def __dir__() -> list[str]:
    # Names for scripts; the lower layers can be imported too.
    inner = {"accounts", "base", "concave", "statics", "studio"}
    return sorted({*__all__, *_ROOMS} - inner)
