"""Verdicts on published claims: of the paper, and of others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.accounts.account import Account, Section, Table
from stepwell.accounts.head import About
from stepwell.base import Quantity, Schema, record

if TYPE_CHECKING:
    from stepwell.accounts.shape import Shape
    from stepwell.paper import Verdicts


def paper_schema(_shape: Shape | None = None) -> Schema:
    """What is reported of verdicts."""
    return (Quantity("claims", read=lambda found: found, holds=[_CLAIM]),)


_ID, _REASON = Quantity("id", head="claim", read="claim.id"), Quantity("reason", head="reason")
_STATEMENT = Quantity("claim", head="statement", read="claim.claim")
_TOLERANCE = Quantity("tolerance", head="within", read="claim.tolerance")
_COMPARED: Schema = (
    Quantity("where", head="where", read="claim.where"),
    Quantity("paper", head="published", read="claim.paper_value"),
    Quantity("ours", head="Stepwell"),
    Quantity("verdict", head="verdict", read=lambda one: str(one.verdict)),
)
_CLAIM: Schema = (_ID, _STATEMENT, *_COMPARED[:2], _TOLERANCE, *_COMPARED[2:], _REASON)


def verdicts_account(found: Verdicts, about: About | None = None) -> Account:
    """What is reported of verdicts."""
    rows = [record(_CLAIM, one) for one in found]
    reasons = [row for row in rows if row["reason"]]
    compared, wide = (_ID, *_COMPARED), (_TOLERANCE, _STATEMENT)
    return Account(
        found,
        "Validation against published claims",
        "paper/1",
        paper_schema(),
        answer=f"{found.agreed} of {len(found)} claims agree",
        about=about or About(),
        sections=(
            Section("Claims", [Table(compared, lambda: rows, "", wide, None, "claims")]),
            Section(
                "Reasons and limits",
                [Table((_ID, _REASON), lambda: reasons, most=None, more="reasons")],
            ),
        ),
    )
