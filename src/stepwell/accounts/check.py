"""A verdict on a design: whether samples reproduce its target, and the critical change."""

from stepwell import base
from stepwell.accounts import changes, events, yields
from stepwell.accounts.head import CALIBRATED, About, DesignShape, keys
from stepwell.accounts.parts import Account, Fact, Replay, Warned
from stepwell.accounts.words import assumed, calibration, cells_of, degenerate, scattered, tie_notes
from stepwell.base import Quantity, amount, percent
from stepwell.design import Check, Measurement

# The unit of the tolerance of each measured part; percent for all others.
_UNITS = {"d": "mm", "lever": "mm", "friction": "N"}


def check_schema(shape: DesignShape) -> base.Schema:
    """What is reported of a verdict."""
    # A tolerance is in one of these units and null in the others.
    units = ("mm", "percent", "N") if shape.levers else ("percent", "N")
    measured = (
        *keys(cell=int, what=str),
        *(_tolerance(when, unit) for when in ("now", "then") for unit in units),
        *keys(fraction_before=(float, "before"), fraction_after=(float, "after")),
    )
    return (
        *yields.CHAIN,
        *keys(verdict=(str, lambda check: str(check.verdict)), reason=str, target=str, does=str),
        *keys(meets_target=bool),
        *base.read_off(yields.counted_schema(shape), "yield_"),
        Quantity("critical_change", holds=changes.change_schema(shape), missing=True),
        *base.in_measure(keys(peak_force="N", dissipated="mJ"), shape.measure),
        *base.read_off(events.RATE, "path"),
        *keys(pull=("g", _mass), warnings=[str]),
        Quantity("measure", holds=base.in_measure(measured, shape.measure), missing=True),
        *keys(ties=([str], lambda check: tie_notes(check.path.degenerate, check.chain))),
        CALIBRATED,
        Quantity("assumptions", read="yield_.assumptions"),
    )


def _mass(check: Check) -> float | None:
    """The mass [kg] whose weight is the largest force of the actuator."""
    of_force = check.chain.measure is base.Measure.TRAVEL
    return abs(check.peak_force) / base.GRAVITY if of_force else None


def _tolerance(when: str, unit: str) -> Quantity:
    def read(one: Measurement) -> float | None:
        return getattr(one, when) if _UNITS.get(one.what, "percent") == unit else None

    return Quantity(when, unit, read=read)


def check_account(check: Check, about: About) -> Account:
    """What is reported of a verdict."""
    chain, sampled, change = check.chain, check.yield_, check.critical_change
    none = "no single change within reach breaks the sequence" if check.meets_target else ""
    # The largest force is given in grams too where it is a force.
    mass = _mass(check)
    grams = "" if mass is None else f" ({amount(mass, 'kg', 3)})"
    force = amount(abs(check.peak_force), chain.measure.force_unit, 3)
    facts = (
        Fact("Target", check.target),
        Fact("Reproduces", "" if check.meets_target else check.does),
        Fact("Yield", yields.yield_words(sampled)),
        Fact("Samples", yields.sample_words(sampled)),
        Fact("Critical change", none if change is None else changes.change_words(change)),
        Fact("Actuator", f"{force}{grams} at most; {amount(check.dissipated, 'J', 3)} dissipated"),
        events.rate_fact(check.path),
        Fact("Measure next", _measurement_words(check)),
    )
    title, answer = chain.title or "A design", f"{check.verdict}: {check.reason}"
    origin, seed = f"{cells_of(chain)}.", sampled.seed
    warned = (
        Warned("Warnings", "", check.warnings),
        degenerate(check.path.degenerate, chain),
        scattered(chain),
    )
    sections = {
        "Outcomes of the samples": yields.PICTURES,
        "Motion": Replay(check.target),
        **calibration(about),
        **assumed(chain, sampled.assumptions),
    }
    return Account(check, title, "check/2", answer, facts, sections, warned, origin, seed=seed)


def _measurement_words(check: Check) -> str:
    """The measurement that raises the yield most; "" where none does."""
    one, measure = check.measure, check.chain.measure
    if one is None:
        return ""
    unit = _UNITS.get(one.what, "percent")
    (then,) = base.in_measure([Quantity("then", unit)], measure)
    return (
        f"the {changes.part_words(one.what, measure)} of {check.chain.names[one.cell]} to "
        f"±{base.number(one.then * then.factor, 3)} {then.sign}, and build it as designed: "
        f"the yield rises from {percent(one.before)} to {percent(one.after)}"
    )
