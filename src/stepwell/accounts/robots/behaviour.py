"""Robots with a compiled behaviour: the table row by row, numbers to build, and alternatives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from stepwell import base, files
from stepwell.accounts import parts
from stepwell.accounts.head import About, DesignShape, Row, keys, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Picture, RecordTable
from stepwell.accounts.robots.robot import PARAMETERS, assumed_fact, parameter_section
from stepwell.accounts.yields import tolerance_schema, tolerance_words
from stepwell.base import Quantity, Schema, amount, counted, number, percent, to_unit
from stepwell.robot import BACKS, STEPS, ChosenNumbers, CompiledDesign, RowMargin

if TYPE_CHECKING:
    from stepwell.simulation import CompiledRobot, RowTrial

_ADVANCE = Quantity("advance", "over_u_max", "d/u_max", "trial.advance", ".2f", holds=float)
_TURN = Quantity("turn", "deg", "turn", "trial.turn", "z.1f", holds=float)
_ORDER: Schema = keys(inner_0="N", opens="N", inner_1="N", closes="N")
# The gait of a leg in one word, in tables.
_WORDS = {STEPS.states: "forward", BACKS.states: "backward"}
_ROW: Schema = (
    Quantity("contact", head="contact", read=lambda row: row["margin"].row.contact),
    Quantity("motion", head="motion", read=lambda row: row["margin"].row.motion),
    *(
        Quantity(
            f"{side}_gait",
            head=f"{side} leg",
            read=lambda row, k=k: row["margin"].gaits[k].states,
            form=lambda states: _WORDS.get(states, "idle"),
        )
        for k, side in enumerate(("left", "right"))
    ),
    Quantity("force", "mN", "force", lambda row: row["margin"].force, 3),
    Quantity("anchor", "mm", "anchor", lambda row: row["margin"].anchor, ".2f"),
    *keys(orders=([_ORDER], lambda row: row["margin"].orders)),
    Quantity(
        "simulated",
        holds=(*(_ADVANCE, _TURN), *keys(gaits=([str], "trial.gaits"), right=bool)),
        read=lambda row: row["trial"],
        missing=True,
    ),
)
_PLACES: Schema = (
    Quantity("inner", "mm", "inner q", "places.inner", holds=[float]),
    Quantity("outer", "mm", "outer q", "places.outer", holds=[float]),
    Quantity("inner_bands", head="inner bands", read="places.inner_bands", holds=int, left=False),
    Quantity("outer_bands", head="outer bands", read="places.outer_bands", holds=int, left=False),
    Quantity("moves", "mm", "displacement", "places.moves", holds=[float]),
    Quantity("below", "mm", "foot depth", "places.below", holds=float),
    *keys(
        stiffness=("N/m", "places.band.stiffness"), rest_length=("mm", "places.band.rest_length")
    ),
)
_RIGHT: Schema = (
    Quantity("inner", "mm", "right inner q", holds=[float]),
    Quantity("outer", "mm", "right outer q", holds=[float]),
    Quantity("inner_bands", head="right inner bands", holds=int, left=False),
    Quantity("outer_bands", head="right outer bands", holds=int, left=False),
)
_DESIGN: Schema = (
    *_PLACES,
    Quantity("margin", "mN", "margin", form=3, holds=float),
    Quantity("anchor", "mm", holds=float),
    Quantity(
        "fraction", head="yield", read="built.estimate", form=percent, holds=float, left=False
    ),
    *keys(fraction_low=(float, "built.low"), fraction_high=(float, "built.high")),
    Quantity("step", "over_u_max", "step", form=".2f", holds=float, none="none"),
    *keys(tip_force="mN"),
    # Numbers of the right leg, if they are not those of the left one.
    Quantity("right", read="places.right", holds=_RIGHT, missing=True),
)
_DISPLACED: Schema = (
    Quantity("moves", "mm", "displacement", holds=float),
    Quantity("inner_bands", head="inner bands", holds=int, left=False),
    Quantity("designs", head="designs", holds=int, left=False),
    Quantity("margin", "mN", "best margin", form=3, holds=float, none="none"),
    Quantity("bound", "mN", "bound", form=3, holds=float),
)
_ARENA: Schema = (
    Quantity("arena", head="arena", read="arena.title"),
    Quantity("outcome", head="outcome", read="ending"),
    *keys(reached=(bool, lambda maze: maze.outcome.name == "REACHED"), duration="s"),
)


def _rows(margins: Sequence[RowMargin], trials: Sequence[RowTrial]) -> Sequence[Row]:
    walked = trials or [None] * len(margins)
    return base.rows_of({"margin": margins, "trial": walked})


def _of_design(read: Any) -> Any:
    return lambda result: None if result.design is None else read(result)


COMPILE: Schema = (
    *keys(title=(str, "compiled.behaviour.title"), robot=(str, "compiled.behaviour.robot.title")),
    *keys(table=([keys(contact=str, motion=str)], "compiled.behaviour.rows")),
    *base.read_off(
        keys(decided=bool, searched=int, total=int, met=int, conflict=[str], proved=bool),
        "compiled",
    ),
    *keys(equal_legs=(bool, "compiled.equal_legs")),
    *keys(verified=bool, simulated=(int, lambda result: len(result.trials))),
    *keys(
        relative=("N", "compiled.force"),
        relative_margin=("percent", _of_design(lambda one: one.design.margin / one.compiled.force)),
        swing=("deg", _of_design(lambda one: one.robot.antennas[0].swing)),
        displacement_per_rad=("mm", _of_design(lambda one: one.robot.antennas[0].gear)),
    ),
    replace(PARAMETERS, read=lambda result: files.provenance(result.robot)),
    Quantity("design", holds=_DESIGN, missing=True),
    *keys(antennas_drive=({str: str}, lambda result: dict(_wiring(result)))),
    *keys(
        rows=(
            [_ROW],
            lambda result: _rows(result.design.rows if result.design else (), result.walked),
        ),
        alternatives=([_DESIGN], "compiled.designs"),
        displaced=([_DISPLACED], "compiled.displaced"),
        arenas=([_ARENA], "arenas"),
    ),
    Quantity(
        "as_made",
        read=lambda result: result if result.made is not None else None,
        holds=keys(
            mass=("g", "made.mass"),
            rows=([_ROW], lambda result: _rows(result.made_rows, result.made_trials)),
        ),
        missing=True,
    ),
    *keys(
        tolerances=(tolerance_schema(DesignShape()), "compiled.tolerances"),
        samples=(int, "compiled.samples"),
    ),
)


def _wiring(result: CompiledRobot) -> Iterator[tuple[str, str]]:
    """For each antenna the leg whose anchor it moves."""
    return ((one.name, one.leg) for one in result.robot.antennas)


def compiled_robot_account(result: CompiledRobot, about: About) -> Account:
    """What is reported of a compiled behaviour."""
    compiled, design = result.compiled, result.design
    title = compiled.behaviour.title or "A compiled behaviour"
    searched = f"{compiled.searched:,} of {compiled.total:,}"
    facts = [
        Fact("Designs evaluated" if compiled.equal_legs else "Pairs of legs decided", searched),
        Fact("Designs with all rows", f"{compiled.met:,}", FULL),
    ]
    sections: dict[str, Any] = {}
    warned: list[parts.Warned] = []
    if design is not None:
        facts += _design_facts(result, design)
        sections |= _design_sections(result)
        warned += _warnings(result)
    if compiled.equal_legs:
        about_bound = (
            "Bound: half of the smaller change of F0 and of F1 of the inner cell by the "
            "displacement. A leg that changes from forward to backward has no larger margin at "
            "fixed thresholds."
        )
        sections["Displacements and bands"] = RecordTable(
            _DISPLACED, "displaced", about_bound, more="rows"
        )
    legs = "two equal legs" if compiled.equal_legs else "pairs of legs"
    first = _EQUAL if compiled.equal_legs else _UNEQUAL
    sections["Assumptions"] = parts.Notes((first, *_ASSUMPTIONS), FULL)
    hints = ["`--most N` evaluates up to N designs."] * (not compiled.decided)
    origin = f"Found in closed form among {legs}, then simulated."
    return Account(
        result,
        title,
        "compile/1",
        _answer(result),
        facts,
        sections,
        warned,
        origin,
        hints=hints,
        seed=compiled.seed,
        packages=["mujoco"],
    )


_EQUAL = "Both legs are equal, and their cells have negative stiffness at every angle."
_UNEQUAL = (
    "Both legs have the same displacement by antennas, foot depth and type of band; their cells "
    "have negative stiffness at every angle."
)
_ASSUMPTIONS = (
    "The order of the cells follows from forces at the stops and the weight on each foot.",
    "A contact displaces the anchor fully; the band returns it at every angle.",
    "Samples have equal bands on one cell with one common deviation.",
    "The numbers hold for the robot as given, with the masses and friction of its file.",
)


def _answer(result: CompiledRobot) -> str:
    compiled, design = result.compiled, result.design
    if design is None:
        if not compiled.conflict:
            return f"Not decided after {counted(compiled.searched, 'design')}"
        rows = {row.contact: row.motion for row in compiled.behaviour.rows}
        some = ", ".join(f"{contact}: {rows[contact]}" for contact in compiled.conflict)
        if compiled.proved:
            legs = "No two equal legs have" if compiled.equal_legs else "No two legs have"
            return f"{legs} together: {some}. This is proved for every anchor"
        return f"None of {counted(compiled.total, 'design')} has together: {some}"
    text = f"{_anchors(design.places)}, displacement {_point(design.places.moves)} mm"
    if not result.trials:
        return f"{text}: all rows in closed form, not simulated"
    if result.verified:
        return f"{text}: all rows, also in simulation"
    return f"{text}: all rows in closed form, but in none of {len(result.trials)} simulated designs"


def _point(at: base.Vec2) -> str:
    return f"({', '.join(number(to_unit(one, 'mm')) for one in at)})"


def _anchors(places: ChosenNumbers) -> str:
    texts = [f"{_point(one.inner)} mm inner, {_point(one.outer)} mm outer" for one in places.legs]
    if places.right is None:
        return f"q = {texts[0]}"
    return f"left q = {texts[0]}, right q = {texts[1]}"


def _design_facts(result: CompiledRobot, design: CompiledDesign) -> list[Fact]:
    compiled, places = result.compiled, design.places
    relative = percent(design.margin / compiled.force)
    low, high = map(percent, design.built[2:])
    antenna, robot = result.robot.antennas[0], result.robot
    within = tolerance_words(compiled.tolerances, robot.legs[0].chain)
    force = f"{to_unit(design.margin, 'mN'):.3g} mN"
    margin = f"{force}, {relative} of k r, or {amount(design.anchor, 'm')}"
    wired = ", ".join(f"{one} moves {leg}" for one, leg in _wiring(result))
    return [
        Fact("Margin", f"{margin} of one anchor"),
        Fact("Yield", f"{percent(design.built.estimate)} ({low} to {high}) within {within}"),
        Fact("Bands", _bands(places)),
        Fact("Foot depth", amount(places.below, "m"), FULL),
        Fact("Gearing", _gearing(antenna.gear, antenna.swing, design.tip_force), FULL),
        Fact("Antennas", wired, FULL),
        replace(assumed_fact(robot), level=FULL),
    ]


def _bands(places: ChosenNumbers) -> str:
    band = places.band
    kind = f"{number(band.stiffness)} N/m, {amount(band.rest_length, 'm')}"
    counts = [f"{one.inner_bands} inner, {one.outer_bands} outer" for one in places.legs]
    if places.right is None:
        return f"{counts[0]}, each {kind}"
    return f"left {counts[0]}, right {counts[1]}, each {kind}"


def _gearing(gear: float, swing: float, force: float) -> str:
    per = f"{to_unit(gear, 'mm'):.3g} mm per rad, {math.degrees(swing):.3g}° of swing"
    return f"{per}, {to_unit(force, 'mN'):.3g} mN at the tip"


def _table(margins: Sequence[RowMargin], trials: Sequence[RowTrial], about: str) -> RecordTable:
    flat = (
        *_ROW[:6],
        base.Column("d/u_max", lambda row: _walk(row, _ADVANCE), True),
        base.Column("turn [°]", lambda row: _walk(row, _TURN), True),
        base.Column("met", lambda row: _verdict(row["simulated"])),
    )
    return RecordTable(flat, recorded(_ROW, _rows(margins, trials)), about, level=CARD)


def _walk(row: Row, quantity: Quantity) -> str:
    return "" if row["simulated"] is None else quantity.cell(row["simulated"])


def _verdict(simulated: Row | None) -> str:
    return "" if simulated is None else ("yes" if simulated["right"] else "no")


def _design_sections(result: CompiledRobot) -> dict[str, Any]:
    compiled, design = result.compiled, result.design
    assert design is not None
    about = (
        "Force and anchor: smallest force on a cell, and smallest displacement of one anchor, that "
        "change a gait. d/u_max, turn and met: mean motion per cycle in the simulation, with these "
        "antennas pressed all the time."
    )
    sections: dict[str, Any] = {
        "Table": (
            _table(design.rows, result.walked, about),
            Picture("gait-plane", "Forces of the inner cell and thresholds of the outer one"),
            Picture("robot", "The robot from the side and from above"),
        ),
        "Arenas": RecordTable(_ARENA, "arenas", "Runs of this robot; no arena was used to choose."),
    }
    if result.made is not None:
        mass = amount(result.made.mass, "kg")
        about = f"The same robot with the masses of its parts, {mass}. Rail friction is as given."
        sections["As made"] = _table(result.made_rows, result.made_trials, about)
    right = () if compiled.equal_legs else [_of_right(one) for one in _RIGHT]
    columns = (*_PLACES[:4], *right, *_PLACES[4:6], _DESIGN[8], _DESIGN[10], _DESIGN[13])
    sections["Alternatives"] = RecordTable(
        columns,
        recorded(_DESIGN, compiled.designs),
        "Step: part of a forward step in which the foot grips, in closed form.",
        more="designs",
    )
    return {**sections, **parameter_section(result.robot)}


def _of_right(quantity: Quantity) -> base.Column:
    """A column of the right leg; a right leg without own numbers has those of the left one."""

    def cell(row: Row) -> str:
        return quantity.cell(row if row["right"] is None else row["right"])

    return base.Column(quantity.heading, cell, quantity.left is False)


def _warnings(result: CompiledRobot) -> list[parts.Warned]:
    """Rows that fail in the simulation, of the nominal robot and of the robot as made."""
    nominal = [] if result.verified else _failed(result.walked)
    made = _failed(result.made_trials)
    return [
        parts.Warned("Not verified", "These rows fail in the simulation.", nominal),
        parts.Warned("As made", "With the masses of its parts, these rows fail.", made),
    ]


def _failed(trials: Sequence[RowTrial]) -> list[str]:
    return [f"{one.row.contact}: {one.row.motion}." for one in trials if not one.right]
