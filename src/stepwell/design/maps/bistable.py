"""Where a cell stops having two stable states, in the plane of two parameters."""

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.design.maps.outcomes import IMPOSSIBLE, Outcomes
from stepwell.mechanism import Element


class Stability:
    """How many stable states a cell whose parameters vary has, 1 or 2, by (m, 2) values.

    Attributes:
        words: for each limit that is known in closed form, what changes there; none where every
            design has to be asked.
    """

    def __init__(self, outcomes: Outcomes, cell: int, nodes: Floats):
        self._outcomes, self._cell = outcomes, cell
        one, name = outcomes.chain.cells[cell], outcomes.chain.names[cell]
        numbers = outcomes.numbers(cell, nodes)
        self.words: tuple[str, ...] = ()
        if isinstance(one, Element) or numbers is None:
            return
        if not one.bands[0].two_sided or _taut(numbers):
            self.words = (
                f"state 0 of {name} stops being stable: F0 = 0",
                f"state 1 of {name} stops being stable: F1 = 0",
                f"{name} goes slack over its whole travel: r + |q - p| = ℓ0",
            )

    def limits(self, values: Floats) -> Floats:
        """(m, 3) numbers that are all positive where the cell is bistable, in closed form.

        The energy of one band that only pulls has one peak, at θmax = atan2(d_y, d_x) where the
        band is longest (Kamp et al. 2024, Eq. 3), unless it is slack even there, r + |d| <= ℓ0.
        """
        numbers = self._outcomes.numbers(self._cell, values)
        assert numbers is not None
        dx, dy, _, rest, lever, sine = numbers.T[:6]
        cosine = np.sqrt(1.0 - sine**2)
        across, along = dy * cosine, dx * sine
        return np.stack([along + across, along - across, lever + np.hypot(dx, dy) - rest], axis=1)

    def __call__(self, values: Floats) -> Ints:
        """The number of states; `IMPOSSIBLE` where there is no such cell."""
        if self.words:
            return 1 + np.all(self.limits(values) > 0, axis=1).astype(np.int64)
        return np.array([self._ask(one) for one in values], np.int64)

    def _ask(self, values: Floats) -> int:
        try:
            return 1 + int(self._outcomes.design(values).cells[self._cell].is_bistable)
        except ValueError:
            return IMPOSSIBLE


def _taut(numbers: Floats) -> bool:
    # ℓ² is linear in (cos θ, sin θ): over the travel it is smallest at a stop, or at the turn
    # opposite to d, which for d_x > 0 lies outside.
    dx, dy, _, rest, lever, sine = numbers.T[:6]
    x, y = dx + lever * np.sqrt(1.0 - sine**2), np.abs(dy) - lever * sine
    return bool(np.all(dx > 0) and np.all(np.hypot(x, y) >= rest))
