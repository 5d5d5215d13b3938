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
        *keys(reason=str, target=str, does=str, does_it=bool),
        *base.read_off(yields.counted_schema(shape), "yield_"),
        Quantity("killer", holds=changes.change_schema(shape), missing=True),
        *base.in_measure(keys(peak_force="N", dissipated="mJ"), shape.measure),
        *keys(pull=("g", _mass), oddities=[str]),
        Quantity("measure", holds=measured, missing=True),
        *keys(ties=([str], lambda found: tie_notes(found.path.degenerate, found.chain))),
        CALIBRATED,
        Quantity("assumptions", read="yield_.assumptions"),
    )


def _mass(found: Check) -> float | None:
    """The mass [kg] whose weight is the largest force of the actuator."""
    is_force = found.chain.measure is base.Measure.TRAVEL
    return abs(found.peak_force) / base.GRAVITY if is_force else None


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
    chain = found.chain
    facts = (
        Fact("Target", found.target),
        Fact("Reproduces", "" if found.does_it else found.does),
        Fact("Yield", yields.yield_words(found.yield_)),
        Fact("Samples", yields.sample_words(found.yield_)),
        Fact("Critical change", _critical(found)),
        Fact("Actuator", _actuator_words(found)),
        Fact("Measure next", _measurement_words(found)),
    )
    odd = Warned("Out of the ordinary", "", found.oddities)
    return Account(
        found,
        chain.title or "A design",
        "check/2",
        check_schema(Shape.of(chain)),
        origin=f"{cells_of(chain)}.",
        answer=f"{found.verdict}: {found.reason}",
        seed=found.yield_.seed,
        facts=facts,
        warnings=(odd, degenerate(found.path.degenerate, chain)),
        sections={
            "Outcomes of the samples": yields.PICTURES,
            "Motion": Replay(found.target),
            **calibration(about),
            **assumed(chain, found.yield_.assumptions),
        },
    )


def _critical(found: Check) -> str:
    if found.killer is not None:
        return changes.critical_words(found.killer)
    return "no single change within reach breaks it" if found.does_it else ""


def _actuator_words(found: Check) -> str:
    """The largest force of the actuator, where it is a force in grams too, and the energy lost."""
    mass = _mass(found)
    grams = "" if mass is None else f" ({base.amount(mass, 'kg', 3)})"
    return (
        f"{base.amount(abs(found.peak_force), found.chain.measure.force_unit, 3)}{grams} at most; "
        f"{base.amount(found.dissipated, 'J', 3)} lost on the way"
    )


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
