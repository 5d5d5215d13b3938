"""A designed jump: the pair of cells whose snap sets the most energy free, and the proved bound."""

from stepwell.accounts import yields
from stepwell.accounts.chain import cell_columns, named
from stepwell.accounts.design import built_schema
from stepwell.accounts.head import About, DesignShape, keys, recorded
from stepwell.accounts.parts import CARD, TERMINAL, Account, Fact, Picture, RecordTable, Text
from stepwell.accounts.robots import jumps
from stepwell.base import Quantity, Schema, amount, number, percent
from stepwell.robot import JumpDesign, Task

_CELLS = built_schema(DesignShape())
_HOLES = Picture("holes", "The plates of each cell with p, q and the holes, origin and axes")
JUMP_DESIGN: Schema = (
    *keys(title=(str, "hopper.title"), task=(str, lambda made: str(made.hopper.task))),
    *keys(mass=("g", "hopper.mass"), foot_mass=("g", "hopper.foot_mass")),
    *keys(copies=(int, "hopper.copies"), holes=("mm", "means.pitch")),
    *keys(stretch_limit=(float, "means.stretch"), force_limit=("N", "hopper.actuator.force")),
    Quantity("snap", holds=jumps.RELEASE),
    *keys(peak_force=("N", "snap.peak_force"), stretch=(float, "found.stretch")),
    Quantity("bound", "mJ", read="energy_bound"),
    *keys(bound_by=(str, "limited_by"), fraction_of_bound=(float, "of_bound")),
    *keys(candidates=(int, "found.candidates")),
    Quantity("flight", holds=jumps.PREDICTED),
    *keys(cells=([_CELLS], lambda made: named(made.hopper.chain))),
    Quantity("yield", read="yield_", holds=yields.inner_yield_schema(DesignShape())),
)
_ALIKE = (
    "Energies are of all equal chains of the hopper together. Further cells in series set no more "
    "energy free in one snap, which is proved for falling forces; equal chains side by side add up."
)


def jump_design_account(made: JumpDesign, about: About) -> Account:
    """The snap of a designed hopper, its bound, its yield and its cells."""
    hopper, snap, found = made.hopper, made.snap, made.found
    strikes = hopper.task is Task.STRIKE
    flight = f"{amount(made.flight.energy, 'J', 3)} at {number(made.flight.speed, 3)} m/s"
    if not strikes:
        flight += f", {amount(made.flight.height, 'm', 3)} high"
    lifted = f"; the lift of {amount(snap.load, 'N', 3)} leaves {amount(snap.energy, 'J', 3)}"
    by = {"force": "the actuator's force", "stretch": "the allowed stretch"}[made.limited_by]
    proved = (
        f"no pair gives more than {amount(made.energy_bound, 'J', 3)} within {by}, which is "
        f"proved; this one gives {percent(made.of_bound)} of it"
    )
    stretched = f"{number(found.stretch, 3)} times, at most {number(made.means.stretch, 3)}"
    needs = f"{amount(snap.peak_force, 'N', 3)} of {amount(hopper.actuator.force, 'N', 3)}"
    facts = (
        Fact("Energy set free", f"{amount(snap.of_springs, 'J', 3)}{lifted}"),
        Fact("Ratio", f"{number(snap.ratio, 3)} k S², over {amount(snap.foot_travel, 'm', 3)}"),
        Fact("Bound", proved),
        Fact("Without losses", flight),
        Fact("Actuator", needs),
        Fact("Bands", f"stretched {stretched}"),
        *yields.counted_facts(made.yield_),
        Fact("Holes", f"{amount(made.means.pitch, 'm')} apart", TERMINAL),
    )
    rows = recorded(_CELLS, named(hopper.chain))
    anchors = "p is the anchor on the inner block, q on the outer block; the foot is between them."
    cells = RecordTable(cell_columns(_CELLS, hopper.chain), rows, anchors, level=CARD)
    method = (
        f"Most energy times yield of the 20 best of {found.candidates} pairs on the holes that "
        f"snap; the snap is verified by the engine."
    )
    sections = {
        "Cells, innermost first": (cells, _HOLES),
        "Outcomes of the samples": yields.other_outcomes(made.yield_),
        "Method": (Text(method, CARD), Text(_ALIKE)),
    }
    answer = f"{amount(snap.energy, 'J', 3)} in one snap, yield {percent(made.yield_.fraction)}"
    if not strikes:
        answer += f"; at most {amount(made.flight.height, 'm', 3)} high"
    origin = "Found by search, computed by statics; `stepwell jump` simulates it."
    warned = [yields.advised(made.yield_)]
    title = hopper.title or "Hopper"
    common = {"seed": made.yield_.seed, "origin": origin}
    return Account(made, title, "jump_design/1", answer, facts, sections, warned, **common)
