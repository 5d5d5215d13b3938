"""The branches a chain can stand on, and the relays that concave cells are."""

from stepwell.sequences.branches.branches import Branches, Travels, drive_slip
from stepwell.sequences.branches.checks import Drive, checked_state, driven, refuse_friction
from stepwell.sequences.branches.passages import Section, passages_of, state_of
from stepwell.sequences.branches.relays import Order, Relays, order_kept, relays, shortest
from stepwell.sequences.branches.windows import windows

__all__ = [
    "Branches",
    "Drive",
    "Order",
    "Section",
    "Relays",
    "Travels",
    "checked_state",
    "drive_slip",
    "driven",
    "passages_of",
    "order_kept",
    "refuse_friction",
    "relays",
    "shortest",
    "state_of",
    "windows",
]
