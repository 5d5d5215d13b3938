"""Claims about the energy landscape of two cells (Fig. 2B)."""

from itertools import product

import numpy as np
from scipy import ndimage

from stepwell.base import Floats, InputError
from stepwell.concave import certify, simple
from stepwell.mechanism import Cell, Chain
from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.mechanisms.designs import PAIRS, monostable_pair, pair_cycle

_NODES = 401


@claim("Fig. 2B", "more than 1", "exact")
def wells() -> Finding:
    """The landscape of two cells has several wells even where the outer cell is monostable."""
    chain = monostable_pair().chain
    states, seen = stable_states(chain), count_minima(landscape(chain))
    others = [pair_cycle(pathway).chain for pathway in PAIRS]
    four = {len(stable_states(other)) for other in others}
    return judged(
        not chain.cells[1].is_bistable and len(states) == seen >= 2,
        f"{seen} wells: {' and '.join(states)}",
        note=f"Counted on a grid of {_NODES} × {_NODES} with its edges, and by the forces that "
        f"hold each corner; both agree. The outer cell alone has one stable state; pairs of "
        f"bistable cells have {', '.join(map(str, sorted(four)))}.",
        otherwise=f"The grid shows {seen}, the corners' forces hold {len(states)}, outer bistable: "
        f"{chain.cells[1].is_bistable}.",
    )


def stable_states(chain: Chain) -> list[str]:
    """Corners of the square of travels that are local minima of the total energy, strictly.

    The energy is a sum over the cells, so it is lowest where each cell's is; and cells whose
    force falls have no minimum between their stops.

    Raises:
        ValueError: a cell without the proof that its force falls.
    """
    return ["".join(state) for state in product(*map(_held, chain.levers))]


def _held(cell: Cell) -> str:
    plain = simple(cell)
    if plain is None or not certify(plain, 0.0):
        raise InputError(f"{cell!r}: must be a cell whose force is proved to fall.")
    return "0" * (cell.force_0 > 0) + "1" * (cell.force_1 < 0)


def landscape(chain: Chain, nodes: int = _NODES) -> Floats:
    """(nodes, nodes) total energy [J] over the travels of two cells, stops included."""
    inner, outer = (
        cell.energy(cell.angle(np.linspace(0.0, cell.full_travel, nodes))) for cell in chain.levers
    )
    return inner[:, None] + outer


def count_minima(energy: Floats) -> int:
    """Local minima of a sampled landscape, its edges included.

    A node counts where none of its up to eight neighbours is lower, nodes side by side once.
    """
    lowest = energy <= ndimage.minimum_filter(energy, size=3, mode="nearest")
    _, count = ndimage.label(lowest, structure=np.ones((3, 3)))  # pyright: ignore[reportGeneralTypeIssues]
    return int(count)


CLAIMS = (wells,)
