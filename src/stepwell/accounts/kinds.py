"""Which function has the account of a class, and which the schema of a kind of record."""

from dataclasses import replace
from importlib import import_module
from operator import attrgetter
from typing import Any

from stepwell.accounts.head import About
from stepwell.accounts.parts import Account
from stepwell.accounts.rendering.card import card
from stepwell.base import InputError, of_kind

# The account of a class: the file in this folder, and the function in it.
ACCOUNTS: dict[str, str] = {
    "Arena": "robot:arena_account",
    "AsBuilt": "lab.as_built:as_built_account",
    "Atlas": "atlas:atlas_account",
    "BandFit": "lab.band:band_account",
    "BandTest": "lab.band:band_test_account",
    "Batch": "lab.read:batch_account",
    "Calibration": "lab.calibrate:calibration_account",
    "Cell": "chain:cell_account",
    "CellTest": "lab.compare:series_account",
    "Chain": "chain:chain_account",
    "Check": "check:check_account",
    "Comparison": "lab.compare:comparison_account",
    "Convergence": "study:convergence_account",
    "Cycle": "run:cycle_account",
    "Design": "design:design_account",
    "Element": "chain:cell_account",
    "Event": "events:event_account",
    "ImplicitGraph": "graph:implicit_graph_account",
    "Impossible": "design:impossible_account",
    "Installation": "package:installation_account",
    "Landing": "events:landing_account",
    "MapView": "map:map_account",
    "Margin": "changes:margin_account",
    "Maze": "walks:maze_account",
    "MemoryReading": "graph:reading_account",
    "PairTest": "lab.compare:series_account",
    "Path": "run:path_account",
    "Prediction": "robot:prediction_account",
    "Presets": "package:presets_account",
    "Program": "program:program_account",
    "Recording": "lab.read:recording_account",
    "Reprogramming": "design:reprogramming_account",
    "Robot": "robot:robot_account",
    "Robustness": "design:robustness_account",
    "Run": "run:run_account",
    "Sequence": "graph:sequence_account",
    "Status": "study:study_account",
    "Survival": "yields:survival_account",
    "Sweep": "study:sweep_account",
    "TransitionGraph": "graph:graph_account",
    "Unreachable": "program:unreachable_account",
    "Verdicts": "package:verdicts_account",
    "Walk": "walks:walk_account",
    "Walked": "graph:walked_account",
    "Yield": "yields:yield_account",
}
# The schema of a kind of record, with the version of its names; some are functions of a `Shape`.
KINDS: dict[str, str] = {
    "atlas/1": "atlas:ATLAS",
    "check/2": "check:check_schema",
    "convergence/1": "study:CONVERGENCE",
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
    "sweep/1": "study:SWEEP",
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
