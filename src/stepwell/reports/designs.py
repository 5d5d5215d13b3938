"""What folders of designs have: found, judged, changed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from stepwell.accounts import Account
from stepwell.design import Yield
from stepwell.reports.write import Contents, Draw, design_text
from stepwell.studio.replay import replay

if TYPE_CHECKING:
    from stepwell.design import Check

# Samples that are drawn around the nominal design, and cells that fit into a figure.
_CLOUD, _DRAWABLE_CELLS = 600, 16
# Cells of which a page plays the motion.
MOST_PLAYED = 12


def contents(account: Account) -> Contents:
    """What the folder of a result has besides its page."""
    return _CONTENTS[type(account.value).__name__](account.value, account)


def _check(found: Check, account: Account) -> Contents:
    chain = found.chain
    plays = len(chain) <= MOST_PLAYED
    return Contents(
        "check",
        "check.json",
        {"design.toml": design_text(account)},
        on_page=_of_yield(found.yield_) if isinstance(found.yield_, Yield) else {},
        motion=partial(replay, chain, title=chain.title) if plays else None,
    )


def _of_yield(found: Yield) -> dict[str, Draw]:
    from stepwell import figures

    draws: dict[str, Draw] = {"yield": partial(figures.yield_bars, found)}
    if len(found.chain) <= _DRAWABLE_CELLS:
        draws["force-plane"] = partial(
            figures.force_plane, found.chain, clouds=found.end_forces(_CLOUD)
        )
    return draws


_CONTENTS: dict[str, Callable[..., Contents]] = {
    "Check": _check,
}
