"""The branches a chain can stand on, and how far it moves as relays do."""

from stepwell.sequences.branches.branches import Branches, drive_slip
from stepwell.sequences.branches.checks import Drive, checked_state, driven, refuse_friction
from stepwell.sequences.branches.element import element_of
from stepwell.sequences.branches.passages import Section, passages_of, state_of
from stepwell.sequences.branches.relays import Order, order_kept
from stepwell.sequences.branches.windows import windows
