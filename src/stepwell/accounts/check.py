"""A verdict on a design: whether the real one reproduces its target, and what breaks it."""

from stepwell import base
from stepwell.accounts import changes, yields
from stepwell.accounts.head import CALIBRATED, About, Shape, keys
from stepwell.accounts.parts import Account, Fact, Replay, Warned
from stepwell.accounts.words import assumed, calibration, cells_of, degenerate, tie_notes
from stepwell.base import Quantity
from stepwell.design import Check, Measurement

# What a measurement is of, in words, and the unit of its tolerance.
_MEASURED = {
    "d": ("anchors", "mm"),
    "stiffness": ("stiffness", "percent"),
    "rest_length": ("rest length", "percent"),
    "lever": ("lever", "mm"),
    "friction": ("friction", "N"),
    "force_scale": ("{force}s", "percent"),
    "travel_scale": ("{travel}s", "percent"),
}


def check_schema(shape: Shape) -> base.Schema:
    """What is reported of a verdict."""
    measured = base.in_measure(_measurement(shape), shape.measure)
    return (
        *yields.CHAIN,
        Quantity("verdict", read=lambda found: str(found.verdict)),
        *keys(reason=str, target=str, does=str, meets_target=bool),
        *base.read_off(yields.counted_schema(shape), "yield_"),
        Quantity("critical_change", holds=changes.change_schema(shape), missing=True),
        *base.in_measure(keys(peak_force="N", dissipated="mJ"), shape.measure),
        *keys(pull=("g", _mass), warnings=[str]),
        Quantity("measure", holds=measured, missing=True),
        *keys(ties=([str], lambda found: tie_notes(found.path.degenerate, found.chain))),
        CALIBRATED,
        Quantity("assumptions", read="yield_.assumptions"),
    )


def _mass(found: Check) -> float | None:
    """The mass [kg] whose weight is the largest force of the actuator."""
    of_force = found.chain.measure is base.Measure.TRAVEL
    return abs(found.peak_force) / base.GRAVITY if of_force else None


def _measurement(shape: Shape) -> base.Schema:
    """A measurement whose tolerance is in one of these units; the others have null."""
    units = ("mm", "percent", "N") if shape.levers else ("percent", "N")
    return (
        *keys(cell=int, what=str),
        *(_tolerance(when, unit) for when in ("now", "then") for unit in units),
        *keys(share_before=(float, "before"), share_after=(float, "after")),
    )


def _tolerance(when: str, unit: str) -> Quantity:
    def read(found: Measurement) -> float | None:
        return getattr(found, when) if _MEASURED[found.what][1] == unit else None

    return Quantity(when, unit, read=read)


def check_account(found: Check, about: About) -> Account:
    """What is reported of a verdict."""
    chain, sampled = found.chain, found.yield_
    broken = "no single change within reach breaks it" if found.meets_target else ""
    if found.critical_change is not None:
        broken = changes.change_words(found.critical_change)
    # The largest force is one in grams too where it is a force.
    mass, unit = _mass(found), chain.measure.force_unit
    grams = "" if mass is None else f" ({base.amount(mass, 'kg', 3)})"
    force, lost = base.amount(abs(found.peak_force), unit, 3), base.amount(found.dissipated, "J", 3)
    facts = (
        Fact("Target", found.target),
        Fact("Reproduces", "" if found.meets_target else found.does),
        Fact("Yield", yields.yield_words(sampled)),
        Fact("Samples", yields.sample_words(sampled)),
        Fact("Critical change", broken),
        Fact("Actuator", f"{force}{grams} at most; {lost} lost on the way"),
        Fact("Measure next", _measurement_words(found)),
    )
    title, answer = chain.title or "A design", f"{found.verdict}: {found.reason}"
    origin, seed = f"{cells_of(chain)}.", sampled.seed
    odd = Warned("Out of the ordinary", "", found.warnings)
    warned = (odd, degenerate(found.path.degenerate, chain))
    sections = {
        "Outcomes of the samples": yields.PICTURES,
        "Motion": Replay(found.target),
        **calibration(about),
        **assumed(chain, sampled.assumptions),
    }
    return Account(found, title, "check/2", answer, facts, sections, warned, origin, seed=seed)


def _measurement_words(found: Check) -> str:
    """Which measurement makes a design surest; "" where none does."""
    one = found.measure
    if one is None:
        return ""
    measure = found.chain.measure
    what, unit = _MEASURED[one.what]
    (then,) = base.in_measure([Quantity("then", unit)], measure)
    part = what.format(force=measure.force, travel=measure.travel)
    return (
        f"the {part} of {found.chain.names[one.cell]} to "
        f"±{base.number(one.then * then.factor, 3)} {then.sign}, and make it as drawn: "
        f"{base.percent(one.before)} become {base.percent(one.after)}"
    )
