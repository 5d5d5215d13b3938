"""The paper's designs: six unit cells, and a pair of cells for each pathway."""

from functools import cache

from stepwell.files import preset
from stepwell.mechanism import Cell, Chain
from stepwell.sequences import Cycle, Pathway

# Names of the presets, by their anchor q [mm].
CELLS = {
    "(10, 0)": "paper-cell-10-0",
    "(0, 0)": "paper-cell-0-0",
    "(20, 0)": "paper-cell-20-0",
    "(10, -15)": "paper-cell-10-m15",
    "(20, 15)": "paper-cell-20-15",
    "(0, -15)": "paper-cell-0-m15",
}
PAIRS = {
    Pathway.CLOCKWISE: "paper-forward",
    Pathway.COUNTERCLOCKWISE: "paper-counterclockwise",
    Pathway.VIA_01: "paper-via-01",
    Pathway.VIA_10: "paper-via-10",
}


@cache
def six_cells() -> dict[str, Cell]:
    """The unit cells of Figs. 1D and 1E, by their anchor q [mm]."""
    return {q: preset(name).cells[0] for q, name in CELLS.items()}


@cache
def pair_cycle(pathway: Pathway) -> Cycle:
    """The cycle of the pair of cells that shows a pathway in Fig. 2."""
    return preset(PAIRS[pathway]).cycle()


def outer_anchor(pathway: Pathway) -> tuple[float, float]:
    """Anchor q [m] of the outer cell of that pair; the inner one has (10, 0) mm in all."""
    return pair_cycle(pathway).chain.levers[1].bands[0].q


@cache
def monostable_pair() -> Cycle:
    """The inner cell of all pairs with the one monostable unit cell outside of it."""
    inner = pair_cycle(Pathway.CLOCKWISE).chain.cells[0]
    return Chain((inner, six_cells()["(0, -15)"]), title="Outer cell monostable").cycle()
