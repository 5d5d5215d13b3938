"""What folders of designs have: found, judged, changed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from stepwell.accounts import Account
from stepwell.design import Yield
from stepwell.files import dumps
from stepwell.reports.write import Content, Contents, Draw, design_text
from stepwell.studio.replay import replay

if TYPE_CHECKING:
    from stepwell.design import Check, Design, Reprogramming, Survival

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


def _design(found: Design, account: Account) -> Contents:
    from stepwell import figures

    return Contents(
        "design",
        "design.json",
        {"design.toml": design_text(account), "yield.csv": found.yield_.to_csv},
        {"force-plane": partial(figures.plot, found)},
    )


def _reprogramming(found: Reprogramming, _account: Account) -> Contents:
    files: dict[str, Content] = {}
    if found.chain_after is not None:
        files["design.toml"] = dumps(found.chain_after)
        if isinstance(found.displacement, tuple):
            files["way.csv"] = found.to_csv
    return Contents("reprogram", "reprogram.json", files)


def _yield(found: Yield, account: Account) -> Contents:
    files = {"design.toml": design_text(account), "yield.csv": found.to_csv}
    return Contents("yield", "yield.json", files, _of_yield(found))


def _survival(_found: Survival, account: Account) -> Contents:
    return Contents("yield", "survival.json", {"design.toml": design_text(account)})


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
    "Design": _design,
    "Reprogramming": _reprogramming,
    "Survival": _survival,
    "Yield": _yield,
}
