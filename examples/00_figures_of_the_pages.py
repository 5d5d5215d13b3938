"""The pictures of the README and of the pages, drawn anew: `python 00_figures_of_the_pages.py`."""

import sys
from pathlib import Path

import numpy as np

import stepwell as sw
from stepwell import figures
from stepwell.design import boundaries

DPI = 130


def draw(folder: Path) -> None:
    """Write every picture into `folder`."""
    leg = sw.preset("paper-forward")
    cycle = leg.cycle()
    figures.save(figures.overview(cycle), folder / "overview.png", dpi=DPI)

    x, y = np.linspace(0.0, 0.020, 200), np.linspace(-0.015, 0.015, 200)
    shown = sw.transition_map(leg, "outer", x=x, y=y)
    curves = boundaries(leg, "outer", x=x, y=y)
    design = {"this leg": leg.cells[1].bands[0].q}
    figures.save(figures.transition_map(shown, curves, design), folder / "map.png", dpi=DPI)

    just_past = cycle.snaps[0].stroke + 0.0001
    turned = leg.path([0.020, just_past, 0.020], start="10")
    figures.save(figures.landscape(turned), folder / "turned-back.png", dpi=DPI)

    loading = three_cells().path([0.0, 0.060])
    figures.save(figures.travel_stroke(loading), folder / "left-half-way.png", dpi=DPI)

    # The drawings with the letters; the cell is the paper's with q = (10, -15) mm.
    figures.save(figures.labelled_cell(), folder / "unit-cell.svg")
    figures.save(figures.labelled_chain(leg), folder / "leg.svg")

    library = {name: entry.make() for name, entry in sw.elements.LIBRARY.items()}
    figures.save(figures.element_curves(library), folder / "elements.png", dpi=DPI)


def three_cells() -> sw.Chain:
    """The chain of the theory page, "Sorting", in which a is left half way instead of c."""
    bands = {
        "a": ((0.009405, 0.002068), 53.935),
        "b": ((0.018983, -0.008699), 55.823),
        "c": ((0.008011, -0.010351), 15.018),
    }
    return sw.Chain(
        tuple(sw.Cell(sw.Band((0.0, 0.0), d, k), name=name) for name, (d, k) in bands.items())
    )


if __name__ == "__main__":
    pages = Path(__file__).resolve().parents[1] / "docs" / "img"
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else pages)
