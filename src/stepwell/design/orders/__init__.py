"""What a chain shall do, as states, full cycles and orders of end forces."""

from stepwell.design.orders.full_cycle import checked_cycle, numbered_cycle, orders_of, short
from stepwell.design.orders.orders import Orders, Wish, by_cells_at_1, of_sequence, of_states
from stepwell.design.orders.reached import Reached, reached, searched, unlike, unsearchable
from stepwell.design.orders.target import Seen, Target
