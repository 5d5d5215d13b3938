"""A first build: as-built parameters from its observed motion, and anchors to move."""

from collections.abc import Callable

from stepwell import base
from stepwell.accounts import parts
from stepwell.accounts.head import About, DesignShape, keys
from stepwell.accounts.parts import CARD, FULL, TERMINAL, Account, Fact, Notes, RecordTable, Text
from stepwell.accounts.words import cells_of
from stepwell.accounts.yields import tolerance_words
from stepwell.base import Quantity, Schema, display_unit
from stepwell.lab import AsBuilt, ParameterEstimate

_PLACED: Schema = (
    Quantity("anchor", read="anchor.name"),
    Quantity("was", "mm", holds=[float]),
    Quantity("to", "mm", holds=[float]),
)
_MOVE: Schema = (
    Quantity("move", head="move", read=str),
    *_PLACED,
    Quantity("also", holds=[_PLACED], read=lambda move: move.steps[1:]),
    Quantity("fraction", head="yield", form=base.percent, left=False, holds=float),
)
_WRONG: Schema = (Quantity("wrong", read=str), *_PLACED, Quantity("fraction", holds=float))
_NOT_CONVERGED = (
    "Few random builds have the observed snaps, or the agreeing builds deviate from the "
    "observations by more than their uncertainty: the estimates are not final."
)
_ROWS = 8  # parameters that a terminal shows
_PULL = keys(direction=int, stroke="mm", force="N")


def _in_unit(name: str) -> Callable[[ParameterEstimate], float]:
    """A number of a parameter, in the unit in which this parameter is reported."""
    return lambda known: getattr(known, name) * display_unit(known.parameter.unit)[1]


_KNOWN: Schema = (
    Quantity("parameter", head="parameter", read="parameter.name"),
    Quantity("drawn", head="nominal", read=_in_unit("drawn"), left=False, holds=float),
    Quantity("value", head="as built", read=_in_unit("value"), left=False, holds=float),
    Quantity("doubt", head="±", read=_in_unit("doubt"), left=False, holds=float, missing=True),
    Quantity("doubt_before", head="± before", read=_in_unit("before"), left=False, holds=float),
    Quantity("unit", "", "unit", lambda of: Quantity("", display_unit(of.parameter.unit)[0]).sign),
    Quantity("identified", head="identified", form=("no", "yes").__getitem__, holds=bool),
)


def as_built_schema(shape: DesignShape) -> Schema:
    """Schema of a build; observed snaps are at the drive, which may be a force."""
    seen = (
        Quantity("sequence", missing=True),
        Quantity("snaps_out", shape.drive, read="out", holds=[float], missing=True),
        Quantity("snaps_back", shape.drive, read="back", holds=[float], missing=True),
        Quantity("pulls", holds=[base.in_measure(_PULL, shape.measure)]),
        Quantity("ruler", shape.drive),
        *base.in_measure(keys(scale="N"), shape.measure),
    )
    return (
        *keys(title=(str, "drawing.title"), advice=str, target=str, fraction=float, moves=[_MOVE]),
        *keys(hole="mm", wrong_hole=(float, "chance"), wrong_holes=([_WRONG], "wrong")),
        *keys(seen=seen, known=[_KNOWN], drawn=(int, "samples"), agreeing=float, wider=float),
        *keys(converged=bool),
        *keys(
            anchor=("mm", "tolerances.most.anchor"),
            stiffness=("percent", "tolerances.most.stiffness"),
        ),
    )


def as_built_account(build: AsBuilt, about: About) -> Account:
    """As-built parameters of a prototype, and the moves of anchors with the highest yield."""
    drawing = build.drawing
    samples = f"{build.samples} with {tolerance_words(build.tolerances, drawing)}"
    if build.wider > 1:
        samples += f", {base.number(build.wider)} times those given"
    agreeing = f"{base.percent(build.agreeing)} of random builds move as observed"
    facts = (
        Fact("Target", build.target),
        Fact("Yield as built", base.percent(build.fraction)),
        Fact("Yield after the move", base.percent(build.moves[0].fraction) if build.moves else ""),
        Fact("Observed", _observed(build), TERMINAL),
        Fact("Samples", f"{samples}; {agreeing}", TERMINAL),
        Fact("Holes", _holes(build)),
    )
    anchors = (
        "A motion identifies only q - p of the anchors: p is taken as nominal, and q has the "
        "deviation of both."
    )
    assumed = (
        "Parts vary independently within the tolerances; an anchor may be in an adjacent hole. "
        "An observation counts by its uncertainty alone.",
        "Several builds explain the same motion; where an observation does not identify a "
        "parameter, its mean is that of all builds within the tolerances.",
    )
    moves = "The best moves, and the yield after each."
    known = "Means and standard deviations, with those before the observation."
    if build.single:
        known = "A single random build agrees: its scatter, and what is identified, are not known."
    sections = {
        "Moves of anchors": RecordTable(_MOVE, "moves", moves),
        "As built, as far as observations identify it": RecordTable(
            _KNOWN, "known", known, more="parameters", level=CARD
        ),
        "Assumptions": (
            Text(anchors if DesignShape.of(drawing).levers else "", FULL),
            Notes(assumed, FULL),
        ),
    }
    title, answer = drawing.title or "A first build", f"{build.advice}."
    origin, seed = f"{cells_of(drawing)}.", build.seed
    unsure = [] if build.converged else [f"More than {build.samples} samples may change them."]
    warned = [parts.Warned("Not converged", _NOT_CONVERGED, unsure)]
    kind = "lab.as_built/2"
    return Account(build, title, kind, answer, facts, sections, warned, origin, seed=seed)


def _observed(build: AsBuilt) -> str:
    observed, unit = build.seen, build.drawing.drive_unit
    words = [observed.sequence or ""]
    for strokes, way in ((observed.out, "loading"), (observed.back, "unloading")):
        if strokes is not None:
            each = ", ".join(base.amount(one, unit) for one in strokes)
            words.append(f"snaps at {each} {way}" if each else f"no snap {way}")
    words.append(base.counted(len(observed.pulls), "force") if observed.pulls else "")
    return "; ".join(filter(None, words))


def _holes(build: AsBuilt) -> str:
    if not DesignShape.of(build.drawing).levers:
        return ""
    if not build.chance:
        return "nominal; wrong holes were not searched"
    if not build.wrong:
        return "nominal, as far as observed"
    each = ", ".join(f"{one} in {base.percent(one.fraction)}" for one in build.wrong)
    return f"{each} of the agreeing builds; moving p the opposite way has the same effect"
