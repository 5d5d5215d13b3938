"""A built copy judged from its own recording: verdict, corrections, numbers in tolerances."""

from collections.abc import Callable

from stepwell import base
from stepwell.accounts.head import About, DesignShape, keys
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Notes, RecordTable
from stepwell.accounts.words import cells_of
from stepwell.accounts.yields import tolerance_words
from stepwell.base import Quantity, Schema, amount, display_unit, percent
from stepwell.lab import CopyNumber, CopyTest, CopyVerdict


def _in_unit(name: str) -> Callable[[CopyNumber], float]:
    """A number of a part or a switch, in the unit in which it is reported."""
    return lambda one: getattr(one, name) * display_unit(one.unit)[1]


_NUMBER: Schema = (
    Quantity("name", head="number", holds=str),
    Quantity("nominal", head="nominal", read=_in_unit("nominal"), left=False, holds=float),
    Quantity("value", head="copy", read=_in_unit("value"), left=False, holds=float),
    Quantity("doubt", head="±", read=_in_unit("doubt"), left=False, holds=float),
    Quantity("low", head="from", read=_in_unit("low"), left=False, holds=float),
    Quantity("high", head="to", read=_in_unit("high"), left=False, holds=float),
    Quantity("unit", "", "unit", lambda one: Quantity("", display_unit(one.unit)[0]).sign),
    Quantity("within", head="within", form=("no", "yes").__getitem__, holds=bool),
)
_HOLE: Schema = (
    Quantity("anchor", read="anchor.name"),
    Quantity("was", "mm", holds=[float]),
    Quantity("to", "mm", holds=[float]),
    Quantity("fraction", holds=float),
)


def check_copy_schema(shape: DesignShape) -> Schema:
    """What is reported of a built copy."""
    return (
        *keys(title=(str, "design.title"), recording=(str, "source")),
        *keys(verdict=(str, lambda copy: str(copy.verdict)), reason=str, corrections=[str]),
        *keys(target=str, sequence=str, fraction=(float, "right")),
        *keys(parts=[_NUMBER], switches=[_NUMBER]),
        Quantity("wrong_hole", read="wrong", holds=_HOLE, missing=True),
        *keys(other_holes=([_HOLE], "others")),
        *base.in_measure(keys(error="N", range="N", friction="N"), shape.measure),
        *keys(loss="percent", covered="percent"),
    )


def copy_test_account(copy: CopyTest, about: About) -> Account:
    """What is reported of a built copy."""
    unit = copy.design.measure.force_unit
    decided = copy.verdict is not CopyVerdict.UNDECIDED
    within = sum(one.within for one in copy.switches)
    facts = (
        Fact("Target", copy.target),
        Fact("Copy does", copy.sequence),
        Fact("Sure", f"{percent(copy.right)} of the copies left possible have the target"),
        Fact("Correct", "; ".join(copy.corrections) if decided else ""),
        Fact("Switches", f"{within} of {len(copy.switches)} within the tolerance"),
        Fact("Tolerances", tolerance_words(copy.tolerances, copy.design)),
        Fact("Fit", f"{amount(copy.error, unit, 3)}, {percent(copy.error / copy.range)} of range"),
        Fact("Friction", f"{amount(copy.friction, unit, 3)}, loss {percent(copy.loss)}", FULL),
        Fact("Recording", copy.source),
    )
    criterion = (
        "A number is outside if it is beyond its tolerance by more than two standard deviations. "
        "Intervals of switches hold 99 % of 200 copies within the tolerances. Only q - p can be "
        "seen: q has the deviation of both anchors."
    )
    sections = {
        "Switches": RecordTable(_NUMBER, "switches", criterion, more="switches", level=CARD),
        "Parts": RecordTable(_NUMBER, "parts", "", more="parts", level=CARD),
        "Assumptions": Notes(
            (
                "The copy is the most probable one: parts within the tolerances, or one anchor in "
                "a neighbouring hole, with friction, loss in unloading, and the zeros of the rig.",
                "Not decided: a fit that misses the force by more than 10 % of its range, half "
                "cycles below 90 % of the stroke, or a sequence that the recording leaves open.",
            ),
            FULL,
        ),
    }
    title, answer = copy.design.title or "A copy", f"{copy.verdict}: {copy.reason}"
    origin = f"{cells_of(copy.design)}."
    schema = check_copy_schema(DesignShape.of(copy.design))
    return Account(copy, title, "check_copy/1", answer, facts, sections, (), origin, schema=schema)
