"""A survival: in how many samples within tolerances a program still ends in its target state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.accounts.account import Account, Fact
from stepwell.accounts.head import CALIBRATED, About
from stepwell.accounts.shape import Shape
from stepwell.accounts.tolerances import counted_facts, counted_schema
from stepwell.accounts.words import assumed, calibration, cells_of, turning_points
from stepwell.base import Quantity, Schema, percent

if TYPE_CHECKING:
    from stepwell.design import Survival


def survival_schema(shape: Shape) -> Schema:
    """What is reported of a survival."""
    return (
        Quantity("title", read="chain.title"),
        Quantity("cells", read="chain.names", holds=[str]),
        Quantity("from", read="start"),
        Quantity("to", read="ends"),
        Quantity("turning_points", shape.drive, holds=[float]),
        *counted_schema(shape),
        Quantity("seed", holds=int),
        Quantity("assumptions"),
        Quantity("calibrated", holds=CALIBRATED, missing=True),
    )


def survival_account(found: Survival, about: About | None = None) -> Account:
    """What is reported of a survival."""
    chain, about = found.chain, about or About(found.chain)
    return Account(
        value=found,
        kind="survival/1",
        schema=survival_schema(Shape.of(chain)),
        title=chain.title or "A program with tolerances",
        origin=f"{cells_of(chain)}.",
        answer=f"The program ends in {found.ends} in {percent(found.share)} of the samples",
        about=about,
        seed=found.seed,
        given={"calibrated": about.calibrated},
        facts=(
            Fact("Target", f"{found.start} to {found.ends} by the program"),
            Fact("Turning points", turning_points(found.turning_points, chain)),
            *counted_facts(found),
        ),
        sections=(calibration(about), assumed(chain, found.assumptions)),
    )
