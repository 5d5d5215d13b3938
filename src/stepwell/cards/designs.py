"""The card of an atlas."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stepwell.cards.html import Card
from stepwell.results import ATLAS_MACHINES, atlas_assumed, atlas_facts, atlas_record

if TYPE_CHECKING:
    from stepwell.studies import Atlas


def _atlas(found: Atlas) -> Card:
    told = atlas_record(found)
    return Card(
        f"Atlas of {told['cells']} cells",
        [atlas_assumed(told)],
        atlas_facts(told),
        ATLAS_MACHINES,
        told["machines"],
        "machines",
    )


DESIGNS: dict[str, Callable[[Any], Card]] = {
    "Atlas": _atlas,
}
