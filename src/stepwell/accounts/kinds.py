"""Which function has the account of a class, and which the schema of a kind of record."""

from dataclasses import replace
from importlib import import_module
from operator import attrgetter
from typing import Any

from stepwell.accounts.head import About
from stepwell.accounts.parts import Account
from stepwell.accounts.rendering.card import card
from stepwell.base import InputError, of_kind

# The function of each class, in the file that has its account.
_ACCOUNTS = {
    "atlas": {"Atlas": "atlas"},
    "chain": {"Cell": "cell", "Chain": "chain", "Element": "cell"},
    "changes": {"Margin": "margin"},
    "check": {"Check": "check"},
    "design": {
        "Design": "design",
        "Impossible": "impossible",
        "Reprogramming": "reprogramming",
        "Robustness": "robustness",
    },
    "events": {"Event": "event", "Landing": "landing"},
    "graph": {
        "ImplicitGraph": "implicit_graph",
        "MemoryReading": "reading",
        "Sequence": "sequence",
        "TransitionGraph": "graph",
        "Walked": "walked",
    },
    "lab.as_built": {"AsBuilt": "as_built"},
    "lab.band": {"BandFit": "band", "BandTest": "band_test"},
    "lab.calibrate": {"Calibration": "calibration"},
    "lab.compare": {"CellTest": "series", "Comparison": "comparison", "PairTest": "series"},
    "lab.read": {"Batch": "batch", "Recording": "recording"},
    "map": {"MapView": "map"},
    "package": {"Installation": "installation", "Presets": "presets", "Verdicts": "verdicts"},
    "program": {"Program": "program", "Unreachable": "unreachable"},
    "robot": {"Arena": "arena", "Prediction": "prediction", "Robot": "robot"},
    "run": {"Cycle": "cycle", "Path": "path", "Run": "run"},
    "study": {"Status": "study"},
    "walks": {"Convergence": "convergence", "Maze": "maze", "Sweep": "sweep", "Walk": "walk"},
    "yields": {"Survival": "survival", "Yield": "yield"},
}
# The account of a class: the file in this folder, and the function in it.
ACCOUNTS: dict[str, str] = dict(
    sorted(
        (name, f"{file}:{of}_account")
        for file, functions in _ACCOUNTS.items()
        for name, of in functions.items()
    )
)
# The schema of a kind of record, with the version of its names; some are functions of a `Shape`.
KINDS: dict[str, str] = {
    "atlas/1": "atlas:ATLAS",
    "check/2": "check:check_schema",
    "convergence/1": "walks:CONVERGENCE",
    "design/2": "design:design_schema",
    "doctor/1": "package:DOCTOR",
    "folder/1": "package:FOLDER",
    "graph/2": "graph:graph_schema",
    "implicit_graph/2": "graph:implicit_graph_schema",
    "lab.as_built/2": "lab.as_built:as_built_schema",
    "lab.band/1": "lab.band:BAND",
    "lab.calibrate/2": "lab.calibrate:CALIBRATE",
    "lab.compare/2": "lab.compare:COMPARE",
    "lab.read/1": "lab.read:READ",
    "map/3": "map:MAP",
    "maze/1": "walks:MAZE",
    "paper/1": "package:PAPER",
    "presets/1": "package:PRESETS",
    "program/2": "program:program_schema",
    "reprogram/2": "design:reprogram_schema",
    "robot/1": "robot:ROBOT",
    "run/2": "run:run_schema",
    "study/1": "study:STUDY",
    "survival/2": "yields:survival_schema",
    "sweep/1": "walks:SWEEP",
    "walk/1": "walks:WALK",
    "yield/2": "yields:yield_schema",
}


def taken_from(place: str) -> Any:
    """What stands at a place of one of these tables; its file is imported first."""
    file, _, name = place.partition(":")
    return getattr(import_module(f"stepwell.accounts.{file}"), name)


def account(value: Any, about: About | None = None, **options: Any) -> Account:
    """What is reported of a result.

    Args:
        value: a result, such as a `Check`.
        about: the design file and the recordings that it was computed from.
        options: of the kind of result, such as `borders` of an atlas.

    Raises:
        ValueError: there is no account of such a value.
    """
    place = of_kind(ACCOUNTS, value)
    if place is None:
        raise InputError(f"{type(value).__name__}: must be one of {', '.join(ACCOUNTS)}.")
    about = about or About(_design(value))
    return replace(taken_from(place)(value, about, **options), about=about)


def _design(value: Any) -> Any:
    """The chain, the robot or the text of which a result was computed, if it has one."""
    for place in ("drawing", "chain", "robot", "walk.robot", "graph.chain", "study.text"):
        try:
            return attrgetter(place)(value)
        except AttributeError:
            continue
    return None


def card_of(value: Any) -> str:
    """What a notebook shows of a value: the card of its account, or what it prints.

    Args:
        value: any of the package.

    Returns:
        HTML with inline styles, for light and dark notebooks alike.
    """
    if of_kind(ACCOUNTS, value) is not None:
        return card(account(value))
    name, text = type(value).__name__, repr(value)
    inside = text.removeprefix(f"{name}(")
    return card(Account(value, name, answer=inside.removesuffix(")") if inside != text else text))
