"""Jumps, throws and blows of a hopper: predicted by statics and simulated."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from stepwell import base, files, robot as robots
from stepwell.accounts import parts
from stepwell.accounts.head import About, keys
from stepwell.accounts.parts import FULL, TERMINAL, Account, Fact, Picture, RecordTable
from stepwell.accounts.robots import robot as of_robot
from stepwell.base import Quantity, Schema, amount, counted, number, percent

if TYPE_CHECKING:
    from stepwell.robot import Hopper, JumpBound, WireSpring
    from stepwell.simulation import EnergyFlow, Jump

_TASK, _STRIKE = robots.Task, robots.Task.STRIKE

_CLOSED = 0.01  # largest error of a balance that closes
# The parts of the balance: names of attributes, and words. The first two are the input.
FLOW = {
    "released": "set free by the springs",
    "actuator": "work of the actuator",
    "flight": "flies",
    "stops": "stops of the cells, until lift-off",
    "inner": "relative motion at lift-off, for the stops",
    "dampers": "dampers",
    "friction": "friction",
    "springs": "loss in the springs",
    "foot": "contact of the foot",
    "lift": "lift before lift-off",
    "residual": "error of the balance",
}
_FLOW: Schema = (
    Quantity("part", head="energy"),
    Quantity("energy", "mJ", "amount", form=4),
    Quantity("fraction", "percent", "of the energy set free", form=".1f"),
)
_HOP: Schema = (
    Quantity("number", head="jump", holds=int, left=False),
    Quantity("snap", "s", "snap", form=".3f"),
    Quantity("lift_off", "s", "lift-off", form=".3f"),
    Quantity("speed", "m/s", "speed", form=".3f"),
    Quantity("height", "mm", "height", form=".1f", none="without an end"),
    Quantity("distance", "mm", "distance", form="z.1f", none="without an end"),
    Quantity("pitch", "deg", "pitch after it", form="z.1f"),
    *keys(
        delay="ms", landed=bool, stop_speed="m/s", peak_force="N", blow="N", efficiency="percent"
    ),
    Quantity("error", "percent", "balance off by", form=".2f"),
)
PREDICTED: Schema = (
    *keys(speed_at_stop="m/s", speed="m/s", energy="mJ", height="mm", distance="mm"),
    *keys(efficiency="percent"),
)
RELEASE: Schema = keys(
    stroke="mm",
    energy="mJ",
    of_springs="mJ",
    foot_travel="mm",
    load="N",
    stored="mJ",
    largest_force="N",
    least_force="N",
    ratio=float,
)
_STEP: Schema = (
    Quantity("time_step", "ms", "time step", form=3),
    Quantity("speed", "m/s", "speed"),
    Quantity("height", "mm", "height", form=".2f", none="without an end"),
    Quantity("error", "percent", "balance off by", form=".2f"),
)
_IMPACT: Schema = (
    Quantity("name", head="impact"),
    Quantity("energy", "mJ", "energy", form=3),
    Quantity("mean_force", "N", "mean force over 1 mm", form=3),
)
_FACTOR: Schema = (
    Quantity("name", head="factor"),
    Quantity("ours", head="ours", form=3, holds=float, left=False),
    Quantity("record", head="record", form=3, holds=float, left=False, missing=True),
    Quantity("ratio", head="record over ours", form=3, holds=float, left=False, missing=True),
)


_SPRING: Schema = (
    Quantity("wire", "mm", "wire"),
    Quantity("coil", "mm", "mean coil"),
    Quantity("coils", head="coils", form=".1f", holds=float, left=False),
    Quantity("rate", "N/m", "rate", form=4),
    Quantity("body_length", "mm", "body and loops", form=3),
    Quantity("load", "N", "load", form=3),
    Quantity("stress", "MPa", "stress", form=3),
    Quantity("allowed", "MPa", "allowed", form=4),
    Quantity("mass", "g", "mass", form=3),
)


def _springs(jump: Jump) -> tuple[WireSpring, ...]:
    return robots.hopper_springs(jump.hopper.chain.levers)


def _flow(flow: EnergyFlow) -> list[dict[str, object]]:
    rows = [(words, getattr(flow, name)) for name, words in FLOW.items()]
    return base.rows_of(
        {
            "part": [words for words, _ in rows],
            "energy": [value for _, value in rows],
            "fraction": [value / flow.released for _, value in rows],
        }
    )


JUMP: Schema = (
    *keys(title=(str, "hopper.title"), task=(str, lambda jump: str(jump.hopper.task))),
    *keys(mass=("g", "hopper.mass"), foot_mass=("g", "hopper.foot_mass")),
    Quantity("snap", holds=RELEASE, read="bound.release"),
    Quantity("bound", holds=PREDICTED),
    Quantity("model", holds=PREDICTED, missing=True),
    *keys(model_reason=str),
    Quantity("stored", "mJ", read="first.flow.stored"),
    Quantity("energy", holds=[_FLOW], read=lambda jump: _flow(jump.first.flow)),
    Quantity("jumps", holds=[_HOP], read=lambda jump: _hops(jump)),
    *keys(balance="percent", speed_change="percent", time_steps=([_STEP], "halved")),
    Quantity("impacts", holds=[_IMPACT], read=lambda jump: robots.impacts(jump.hopper, jump.bound)),
    Quantity("springs", holds=[_SPRING], read=_springs),
    *keys(stored_per_spring="J/kg", released_per_spring="J/kg", released_per_robot="J/kg"),
    Quantity("factors", holds=[_FACTOR]),
    *keys(contact_time=("ms", "settings.contact_time"), origin=(str, "hopper.springs.origin")),
    Quantity(
        "parameters",
        holds=[of_robot.PARAMETER],
        read=lambda jump: files.hopper_parameters(jump.hopper),
    ),
)


def _hops(jump: Jump) -> list[dict[str, object]]:
    names = ("snap", "lift_off", "delay", "speed", "height", "distance", "pitch", "landed")
    names += ("stop_speed", "peak_force", "blow")
    columns = {name: [getattr(hop, name) for hop in jump.hops] for name in names}
    flows = [hop.flow for hop in jump.hops]
    columns["efficiency"] = [flow.efficiency for flow in flows]
    columns["error"] = [flow.error for flow in flows]
    return base.rows_of({"number": range(1, len(jump.hops) + 1), **columns})


def hopper_account(hopper: Hopper, about: About) -> Account:
    """Card of a hopper in a notebook."""
    answer = "A snap of the foot away from the body sets free what the springs store."
    masses = (("Body", hopper.body_mass), ("Foot", hopper.foot_mass))
    facts = [Fact(label, amount(value, "kg")) for label, value in masses]
    facts.append(Fact("Task", str(hopper.task)))
    return Account(hopper, hopper.title or "Hopper", answer=answer, facts=facts)


def jump_account(jump: Jump, about: About) -> Account:
    """Energy, take-off and flight of a hopper, and what separates it from the record."""
    hopper, first, snap = jump.hopper, jump.first, jump.bound.release
    title = hopper.title or "A hopper"
    actuator = (
        f"{number(snap.largest_force, 3)} N pulling, {number(max(-snap.least_force, 0.0), 3)} N "
        f"pushing by statics; it has {number(hopper.actuator.force, 3)} N"
    )
    stored, free = jump.stored_per_spring, jump.released_per_spring
    specific = (
        f"{number(stored, 3)} J/kg of spring stored, {number(free, 3)} set free; "
        f"{number(jump.released_per_robot, 3)} J/kg of hopper"
    )
    facts = (
        Fact("Energy set free", _set_free(jump)),
        Fact("Speed", _three(jump, "speed", "m/s")),
        Fact("Height", "" if hopper.task is _STRIKE else _three(jump, "height", "m")),
        Fact("Efficiency", f"{percent(first.flow.efficiency)} of the energy set free"),
        Fact(
            "Lift-off",
            f"{number(base.to_unit(first.delay, 'ms'), 3)} ms after the snap begins",
            TERMINAL,
        ),
        Fact("Landing", _landing(jump), TERMINAL),
        Fact("Actuator", actuator, TERMINAL),
        Fact("Specific energy", specific, TERMINAL),
        Fact("Energy balance", _balance(jump), TERMINAL),
        Fact("Convergence", _converged(jump), TERMINAL),
        Fact("Model", jump.model_reason, TERMINAL),
        Fact("Steel springs", _steel(jump), TERMINAL),
        Fact("Assumed numbers", _assumed(hopper), TERMINAL),
    )
    flow = "Of the first jump, from the beginning of the snap to the last contact."
    record = (
        "Beside the highest jump of an engineered jumper, 32.9 m with 1,075 J/kg of spring (Hawkes "
        "et al. 2022), without the drag of air. The factors of ours multiply to the last row."
    )
    borne = (
        "Energies without losses. The mean force is of parts that give way by 1 mm; forces in the "
        "simulation depend on its contact time and are no design numbers."
    )
    wound = (
        "Extension springs of wire EN 10270-1 SH without initial tension, by EN 13906-2, with the "
        "rate, length and load of the most loaded band. They are computed and no catalogue parts."
    )
    sections: parts.Sections = {
        "Energy": (
            Picture("energy-flow", "Energy from the springs to the flight"),
            RecordTable(_FLOW, "energy", flow, level=FULL),
        ),
        "Flight": (
            Picture("flight", "Height and travels over time"),
            RecordTable(_HOP, "jumps", "Each jump.", more="jumps", level=FULL),
        ),
        "Record": RecordTable(_FACTOR, "factors", record, level=FULL),
        "Impacts": RecordTable(_IMPACT, "impacts", borne, level=FULL),
        "Steel springs": RecordTable(_SPRING, "springs", wound, level=FULL),
        "Time steps": RecordTable(_STEP, "time_steps", "The first jump again.", level=FULL),
        "Parameters": RecordTable(
            of_robot.PARAMETER, "parameters", "Every number of [hopper].", level=FULL
        ),
        "Assumptions": parts.Notes(_assumptions(jump), FULL),
    }
    fallen = [f"jump {i}" for i, hop in enumerate(jump.hops, 1) if not hop.landed]
    off = max(jump.balance, *(hop.flow.error for hop in jump.hops))
    open_ = [f"The balance is off by {percent(off)}."] if off > _CLOSED else []
    warned = (
        parts.Warned("Landing", "It does not stand on its foot after:", fallen),
        parts.Warned("Energy balance", "Use a smaller time step (`JumpSettings`).", open_),
    )
    origin = "Predicted by statics, and simulated in MuJoCo."
    return Account(
        *(jump, title, "jump/1", _answer(jump), facts, sections, warned, origin),
        packages=["mujoco"],
    )


def _answer(jump: Jump) -> str:
    hopper, first = jump.hopper, jump.first
    if hopper.task is _STRIKE:
        return f"Strikes with {amount(first.flow.flight, 'J', 3)} at {number(first.speed, 3)} m/s"
    high = f"{amount(first.height, 'm', 3)} high" if math.isfinite(first.height) else "away"
    bound = f"; the bound is {amount(jump.bound.height, 'm', 3)}"
    bound *= math.isfinite(first.height)
    if hopper.task is _TASK.THROW:
        return f"Throws {amount(hopper.ball_mass, 'kg')} {high}{bound}"
    if hopper.tilt:
        mean = sum(hop.distance for hop in jump.hops) / len(jump.hops)
        count = counted(len(jump.hops), "jump")
        return f"Jumps {amount(mean, 'm', 3)} forward and {high} in {count}{bound}"
    return f"Jumps {high}{bound}"


def _set_free(jump: Jump) -> str:
    flow, snap = jump.first.flow, jump.bound.release
    of_all = percent(flow.released / flow.stored)
    return (
        f"{amount(flow.released, 'J', 3)}, {of_all} of {amount(flow.stored, 'J', 3)} stored; "
        f"{number(snap.ratio, 3)} k S²"
    )


def _three(jump: Jump, name: str, unit: str) -> str:
    """A number as simulated, of the model and of the bound."""

    def text(value: float) -> str:
        return amount(value, unit, 3) if math.isfinite(value) else "without an end"

    model: JumpBound | None = jump.model
    modelled = "" if model is None else f"model {text(getattr(model, name))}, "
    simulated = text(getattr(jump.first, name))
    return f"{simulated} simulated; {modelled}bound {text(getattr(jump.bound, name))}"


def _landing(jump: Jump) -> str:
    if jump.hopper.task is not _TASK.JUMP:
        return ""
    stood = sum(hop.landed for hop in jump.hops)
    needed = robots.landing_length(jump.hopper, jump.bound.release)
    foot = f"; foot {amount(jump.hopper.foot_length, 'm')}, at least {amount(needed, 'm', 3)}"
    return f"on the foot after {stood} of {counted(len(jump.hops), 'jump')}" + foot * bool(needed)


def _balance(jump: Jump) -> str:
    worst = max(hop.flow.error for hop in jump.hops)
    return (
        f"closes to {percent(worst)} until lift-off, to {percent(jump.balance)} of the energy set "
        f"free over the whole run"
    )


def _converged(jump: Jump) -> str:
    change = jump.speed_change
    if change is None:
        return ""
    first, *_, last = jump.halved
    steps = " to ".join(f"{base.to_unit(one.time_step, 'ms'):g}" for one in (first, last))
    return f"the speed changes by {percent(change)} from steps of {steps} ms"


def _steel(jump: Jump) -> str:
    found = _springs(jump)
    if not found:
        return "none of these wires has the rate, length and load of the bands"
    wires = " to ".join(f"{base.to_unit(one.wire, 'mm'):g}" for one in (found[0], found[-1]))
    coils = " to ".join(f"{one.coils:.0f}" for one in (found[0], found[-1]))
    load = amount(found[0].load, "N", 3)
    return f"wire of {wires} mm, {coils} coils, {load} at the stretch; no catalogue part"


def _assumed(hopper: Hopper) -> str:
    return f"{len(files.hopper_parameters(hopper))}, all those of [hopper]"


def _assumptions(jump: Jump) -> list[str]:
    notes = [
        f"Source of the springs: {jump.hopper.springs.origin}.",
        "The levers have no mass, and the blocks slide along the chain without moving sideways.",
        "Each cell has the force of its bands at every step; springs have no mass of their own.",
        "Impacts are inelastic: the time constant of stops and contacts is "
        f"{base.to_unit(jump.settings.contact_time, 'ms'):g} ms.",
        "The motion is in the plane of the tilt; air has no drag.",
        "The bound has no damper and no friction, and its stop is inelastic.",
    ]
    if jump.hopper.task is not _TASK.JUMP:
        notes.append("The body is fixed, and the ball is guided along the chain until it leaves.")
    return notes
