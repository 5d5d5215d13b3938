"""What a chain shall do, as states, full cycles and orders of end forces."""

from stepwell.design.orders.orders import (
    Orders,
    Wish,
    by_cells_at_1,
    checked_cycle,
    is_state,
    numbered_cycle,
    of_sequence,
    of_states,
    orders_of,
    short,
)
from stepwell.design.orders.reached import (
    Reached,
    landings_of,
    reached,
    searched,
    unlike,
    unsearchable,
)
from stepwell.design.orders.switches import (
    Switches,
    are_relays,
    is_relay,
    relay_cycle,
    switching_forces,
)
from stepwell.design.orders.target import Seen, Target
