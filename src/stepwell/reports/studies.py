"""What folders of studies and atlases have."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial as bound
from typing import TYPE_CHECKING, Any

from stepwell.accounts import Account
from stepwell.base import InputError
from stepwell.reports.write import Contents, Draw

if TYPE_CHECKING:
    from stepwell.studies import Atlas, Status

# Cells whose graphs can be read side by side.
_DRAWABLE_CELLS = 4


def contents(account: Account, **options: Any) -> Contents:
    """What the folder of a result has besides its page."""
    return _CONTENTS[type(account.value).__name__](account.value, **options)


def _study(found: Status, partial: bool = False) -> Contents:
    """Of a study: its table, and its figures; influences are drawn of 50 designs or more.

    Args:
        found: of the study.
        partial: whether the table goes without designs that are missing.

    Raises:
        GapError: designs are missing.
        ValueError: an atlas, which `stepwell atlas show` reports.
    """
    study = found.study
    if study.what == "atlas":
        raise InputError(f"{study.folder}: is an atlas: see `stepwell atlas show`.")
    if not partial:
        study.require_whole()
    from stepwell import figures

    draws: dict[str, Draw] = {"outcomes": bound(figures.outcomes, study)}
    if found.decided:
        draws["influences"] = bound(figures.influences, found.decided)
    return Contents(
        "sweep report",
        "study.json",
        {"study.csv": lambda file: study.to_csv(file, partial=partial)},
        draws,
    )


def _atlas(found: Atlas) -> Contents:
    """Of an atlas: its machines as graphs, if they can be seen side by side."""
    from stepwell import figures

    drawable = found.machines and len(found.chain) <= _DRAWABLE_CELLS
    draws: dict[str, Draw] = {"machines": bound(figures.machines, found)} if drawable else {}
    return Contents("atlas show", "atlas.json", draws=draws)


_CONTENTS: dict[str, Callable[..., Contents]] = {
    "Atlas": _atlas,
    "Status": _study,
}
