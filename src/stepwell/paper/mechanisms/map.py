"""Claims about the transition map (Fig. 2C)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Bools, Floats
from stepwell.design import transition_map
from stepwell.files import preset
from stepwell.paper.claims import Claim, Finding, claim, judged
from stepwell.paper.mechanisms.designs import PAIRS
from stepwell.sequences import Pathway

# Shares of area that the paper's equations and parameters give, with q_out over x 0 to 20 and
# y -15 to 15 mm.
_SHARES = {
    Pathway.COUNTERCLOCKWISE: 0.261,
    Pathway.VIA_01: 0.262,
    Pathway.VIA_10: 0.262,
    Pathway.CLOCKWISE: 0.215,
}
_SHARE_TOLERANCE = 0.001
_PLACES = 400  # each way
_BAND = 0.005  # m


@dataclass(frozen=True)
class PaperMap:
    """The paper's map at the middles of equal rectangles, so that a mean is a share of area.

    Attributes:
        x, y: (n,) anchor q of the outer cell [m].
        pathway: (n, n) code, by place in `Pathway`.
        snap_loading, snap_unloading: (n, n) stroke [m], NaN where there is no snap.
        full_stroke: of every design [m].
    """

    x: Floats
    y: Floats
    pathway: NDArray[np.int8]
    snap_loading: Floats
    snap_unloading: Floats
    full_stroke: float

    def takes(self, *pathways: Pathway) -> Bools:
        """(n, n) whether a design takes one of these pathways."""
        return np.isin(self.pathway, [list(Pathway).index(pathway) for pathway in pathways])

    @property
    def directed(self) -> Bools:
        """(n, n) whether a design takes different ways up and down."""
        return self.takes(Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE)

    @property
    def undirected(self) -> Bools:
        """(n, n) whether a design takes the same way up and down."""
        return self.takes(Pathway.VIA_01, Pathway.VIA_10)


@cache
def paper_map() -> PaperMap:
    """The map of Fig. 2C, each of its designs solved in closed form."""
    x = 0.020 * (np.arange(_PLACES) + 0.5) / _PLACES
    y = -0.015 + 0.030 * (np.arange(_PLACES) + 0.5) / _PLACES
    chain = preset(PAIRS[Pathway.CLOCKWISE])
    found = transition_map(chain, 1, x=x, y=y)
    names = "pathway", "snap_loading", "snap_unloading"
    pathway, loading, unloading = (found[name].to_numpy() for name in names)
    return PaperMap(x, y, pathway, loading, unloading, chain.full_stroke)


def _share(pathway: Pathway) -> Finding:
    share = float(np.mean(paper_map().takes(pathway)))
    return judged(abs(share - _SHARES[pathway]) <= _SHARE_TOLERANCE, f"{share:.3f}")


@claim("Fig. 2C", "rises with |q_y|", "rises from band to band")
def large_qy_undirected() -> Finding:
    """A large |q_y| of the outer cell favours undirected pathways."""
    shown = paper_map()
    shares = _by_band(np.abs(shown.y), np.mean(shown.undirected, axis=1))
    edge = shown.undirected[np.abs(shown.y) > 0.0145]
    return judged(
        bool(np.all(np.diff(shares) > 0)) and shares[-1] > 0.5 > shares[0],
        _listed(shares),
        note=f"Shares of undirected designs in bands of |q_y| 0 to 5, 5 to 10 and 10 to 15 mm. "
        f"It is a tendency and no rule: in the last half millimetre {1 - np.mean(edge):.0%} are "
        f"still directed.",
        otherwise="The share of undirected designs does not rise from band to band past a half.",
    )


@claim("Fig. 2C (our reading)", "rises with q_x", "rises from band to band")
def large_qx_directed() -> Finding:
    """A large q_x of the outer cell favours directed pathways."""
    shown = paper_map()
    column = np.mean(shown.directed, axis=0)
    shares = _by_band(shown.x, column)
    least = shown.x[np.argmin(column)]
    below, above = (np.mean(shown.directed[:, side]) for side in (shown.x < 0.01, shown.x > 0.01))
    turning = shown.takes(Pathway.CLOCKWISE), shown.takes(Pathway.COUNTERCLOCKWISE)
    left = [np.mean(way[:, shown.x < 0.01]) for way in turning]
    right = [np.mean(way[:, shown.x > 0.01]) for way in turning]
    return judged(
        bool(np.all(np.diff(shares) > 0)),
        _listed(shares),
        note="Shares of directed designs in bands of q_x of 5 mm.",
        otherwise=f"Shares of directed designs in bands of q_x of 5 mm, 0 to 20 mm. True from "
        f"q_x = 10 mm on, the inner cell's own, where the share is least (at {least * 1e3:.1f} mm) "
        f"and from where it rises to {column[-1]:.2f}; but it rises as well towards small q_x, to "
        f"{column[0]:.2f}. Of the designs below 10 mm {below:.0%} are directed, of those above "
        f"{above:.0%}. What q_x decides is the sense: directed designs are counterclockwise below "
        f"10 mm ({left[1]:.0%} of all there, clockwise {left[0]:.0%}) and clockwise above "
        f"({right[0]:.0%}, counterclockwise {right[1]:.0%}).",
    )


def _by_band(along: Floats, share: Floats) -> Floats:
    """Means of (n,) shares over bands of (n,) places [m]."""
    number = np.floor(along / _BAND).astype(int)
    return np.array([float(np.mean(share[number == k])) for k in range(number.max() + 1)])


def _listed(shares: Floats) -> str:
    return ", ".join(f"{share:.2f}" for share in shares)


CLAIMS = (
    *(
        Claim(
            f"share-{pathway.label.replace(' ', '-')}",
            f"Share of the map's area that runs {pathway.label}.",
            "Fig. 2C, from its equations and parameters",
            f"{share:.3f}",
            f"{_SHARE_TOLERANCE:g}",
            partial(_share, pathway),
        )
        for pathway, share in _SHARES.items()
    ),
    large_qy_undirected,
    large_qx_directed,
)
