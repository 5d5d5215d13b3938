"""What a chain shall do, as states, full cycles and orders of end forces."""

from stepwell.design.orders.full_cycle import full_cycle, numbered_cycle, orders_of, short
from stepwell.design.orders.goal import Goal, Seen
from stepwell.design.orders.orders import Orders, Wish, by_cells_at_1, of_sequence, of_states
from stepwell.design.orders.reached import Reached, reached, searched, unlike, unsearchable

__all__ = [
    "Goal",
    "Orders",
    "Reached",
    "Seen",
    "Wish",
    "by_cells_at_1",
    "full_cycle",
    "numbered_cycle",
    "of_sequence",
    "of_states",
    "orders_of",
    "reached",
    "searched",
    "short",
    "unlike",
    "unsearchable",
]
