"""Transition maps: the sequence of a chain for all values of two of its parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell import base
from stepwell.base import Drawn, Floats, InputError, Progress, Shown
from stepwell.design.outcomes import IMPOSSIBLE, UNSOLVED, DesignOutcome, Outcomes, Stability
from stepwell.design.parameters import WAY, Parameter, parameter, parameters
from stepwell.mechanism import Chain, Element, SlipError
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.design.plane import Boundary


class MapView(Shown, Drawn):
    """View of a map: `map.stepwell` is a card in a notebook, `map.stepwell.plot()` a figure.

    Args:
        dataset: result of `transition_map` or `parameter_map`.
        boundaries: result of `boundaries` or `parameter_boundaries` for the same axes.
        designs: both parameters in SI of each marked design, by name; the nominal one first.
    """

    def __init__(
        self,
        dataset: xr.Dataset,
        boundaries: Sequence[Boundary] = (),
        designs: Mapping[str, tuple[float, float]] | None = None,
    ):
        self.dataset = dataset
        self.boundaries = tuple(boundaries)
        self.designs = dict(designs or {})

    def __repr__(self):
        title, sizes = self.dataset.attrs.get("title", "no map"), self.dataset.sizes
        counts = " by ".join(str(sizes[axis]) for axis in "xy" if axis in sizes)
        return f"MapView({title}: {counts} designs)"


Axis = tuple[str | Parameter, ArrayLike]
Axes = tuple[tuple[Parameter, Floats], tuple[Parameter, Floats]]
_Attributes = dict[str, object]

# Below this gap, in units of k r, the order is not decided within rounding.
_TIE = 1e-9
_BYTES = 60  # per place, for intermediate and final results


def transition_map(
    chain: Chain, cell: int | str = 1, *, x: ArrayLike, y: ArrayLike, progress: Progress = None
) -> xr.Dataset:
    """Map of the sequence over the anchor q of one cell: `parameter_map` over that anchor.

    Args:
        chain: any number of cells.
        cell: the cell of the anchor, 0 for the innermost, or its name; all its bands move.
        x, y: (nx,), (ny,) increasing coordinates of its anchor q on the outer block [m].
        progress: called with (done, total) while the general engine works.

    Raises:
        ValueError: no such cell, axes that do not increase, or more places than the limit.
        ExtraError: xarray is not installed.

    Source: Kamp et al. 2024, Fig. 2C; closed form: theory page, "Two cells".
    """
    return parameter_map(*anchor(chain, cell, x, y), progress=progress)


def parameter_map(chain: Chain, x: Axis, y: Axis, *, progress: Progress = None) -> xr.Dataset:
    """Map of the sequence over two parameters of a chain.

    Any two parameters of any cells or elements, the actuator's stiffness or friction; names as in
    `parameter`. Designs of concave cells of equal travel, or of any two concave cells, are
    evaluated in closed form if the actuator is rigid; all others by the general engine. `attrs`
    contains both counts.

    Args:
        chain: any number of cells.
        x, y: name and increasing values of a parameter, such as ("inner.stiffness", values), SI.
        progress: called with (done, total) while the general engine works.

    Returns:
        Dataset with dims ("y", "x") and coordinates in SI:
        sequence, int32, codes in its attrs flag_values and flag_meanings, among them
        "impossible" if the ends of a band would meet and "unsolved" if the engine stopped;
        pathway, int8, the same by the names of `Pathway`, for two cells only;
        snap_loading, snap_unloading, stroke [m] of the first snap, NaN if there is none;
        snaps_loading, snaps_unloading, steps from state to state in which the chain snaps
        (a snap passed on from cell to cell counts once); -1 without an answer;
        margin, smallest difference of two F0 or of two F1, over k r of the first cell without a
        varied parameter (of the innermost if there is none): zero exactly on a boundary, infinite
        for one cell, NaN for designs simulated by the general engine, as with elements;
        monostable, whether a cell whose parameter varies is stable in one state only;
        degenerate, whether the design is on a boundary (margin below 1e-9, or a tie of the engine).

    Raises:
        ValueError: no such parameter, values that do not increase or are not allowed, or too many.
        ExtraError: xarray is not installed.

    Source: Kamp et al. 2024, Fig. 2C, for one anchor of two cells; sorting theorem, theory page.
    """
    base.need("tables")
    (first, xs), (second, ys) = axes_of(chain, x, y, 1)
    require_places(len(xs), len(ys))
    outcomes = Outcomes(chain, (first, second), np.array([np.ptp(xs), np.ptp(ys)]))
    nodes = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    scale, _ = _scale(outcomes)
    outcome = outcomes.closed_form(nodes, _TIE * scale)
    waiting = np.flatnonzero(outcome.sequence == UNSOLVED)
    outcomes.simulate(waiting, nodes, outcome, progress)
    for cell in outcomes.turned if len(waiting) else ():
        states = Stability(outcomes, cell, nodes[waiting])
        outcome.monostable[waiting] |= states(nodes[waiting]) == 1
    return _dataset(outcomes, outcome, ((first, xs), (second, ys)), asked=len(waiting))


def anchor(chain: Chain, cell: int | str, x: ArrayLike, y: ArrayLike) -> tuple[Chain, Axis, Axis]:
    """The chain with all bands of a cell at one anchor q, and q.x and q.y as parameters."""
    number, cells = _cell_index(chain, cell), list(chain.cells)
    one = cells[number]
    if isinstance(one, Element):
        name = chain.names[number]
        raise InputError(
            f"cell = {cell!r} is an element, without anchors: use parameter_map over "
            f"'{name}.force_scale', '{name}.travel_scale' or '{name}.friction'."
        )
    cells[number] = replace(one, band=tuple(replace(b, q=one.bands[0].q) for b in one.bands))
    of_cell = {one.part: one for one in parameters(chain) if one.cell == number}
    return replace(chain, cells=tuple(cells)), (of_cell["q.x"], x), (of_cell["q.y"], y)


def axes_of(chain: Chain, x: Axis, y: Axis, least: int) -> Axes:
    """Two parameters with `least` or more values each; ValueError for others."""
    axes: list[tuple[Parameter, Floats]] = []
    for letter, given in (("x", x), ("y", y)):
        try:
            name, numbers = given
        except (TypeError, ValueError):
            raise InputError(
                f"{letter} = {given!r}: must be the name of a parameter and its values, such as "
                f"('{chain.names[0]}.stiffness', np.linspace(20, 40, 50))."
            ) from None
        one = name if isinstance(name, Parameter) else parameter(chain, name)
        values = one.values(numbers, least)
        slips = one.slips(chain, max(values.tolist(), key=abs))
        if slips:
            raise SlipError(slips, WAY)
        if "." not in one.part:
            # Values out of range raise their error here; anchors have no range.
            for value in values[[0, -1]].tolist():
                one.changed(chain, value)
        axes.append((one, values))
    if axes[0][0] == axes[1][0]:
        raise InputError(f"x and y are both {axes[0][0].name!r}: use two different parameters.")
    return axes[0], axes[1]


def require_places(across: int, up: int) -> None:
    """Raise an error for a map of too many places before memory is allocated."""
    memory = across * up * _BYTES / 2**30
    base.require("points", across * up, f"{across} x {up}, which take {memory:.1f} GiB, are")


def _cell_index(chain: Chain, cell: int | str) -> int:
    if isinstance(cell, str) and cell in chain.names:
        return chain.names.index(cell)
    if not isinstance(cell, str) and 0 <= cell < len(chain):
        return int(cell)
    known = base.join_first([f"{i} or {name!r}" for i, name in enumerate(chain.names)], 8)
    raise InputError(f"cell = {cell!r}: must be {known}.")


def _scale(outcomes: Outcomes) -> tuple[float, str]:
    """Unit of the gaps, k r [N] or the largest force of an element, and the cell's name."""
    chain = outcomes.chain
    stays = next((i for i in range(len(chain)) if i not in outcomes.turned), 0)
    cell, name = chain.cells[stays], chain.names[stays]
    own = cell.largest_force if isinstance(cell, Element) else cell.bands[0].stiffness * cell.lever
    return own, name


def _dataset(outcomes: Outcomes, outcome: DesignOutcome, axes: Axes, asked: int) -> xr.Dataset:
    import xarray as xr

    chain, sequence = outcomes.chain, outcome.sequence
    stroke, unit = chain.measure.stroke, chain.measure.travel_unit
    scale, staying = _scale(outcomes)
    turned = " or ".join(chain.names[i] for i in outcomes.turned)
    impossible, unsolved = (int(np.sum(sequence == code)) for code in (IMPOSSIBLE, UNSOLVED))
    about: dict[str, tuple[NDArray[np.generic], _Attributes]] = {}
    if len(chain) == 2:
        # The four pathways come first among the sequences, and OTHER after them.
        pathway = np.minimum(sequence, list(Pathway).index(Pathway.OTHER)).astype(np.int8)
        notes = _flags([p.name.lower() for p in Pathway], np.int8)
        about["pathway"] = pathway, _attributes("order in which the cells load and unload") | notes
    notes = _flags([outcomes.meaning(i) for i in range(len(outcomes.sequences))], np.int32)
    about["sequence"] = sequence, _attributes("states visited in a full cycle") | notes
    for way, at in zip(("loading", "unloading"), outcome.strokes, strict=True):
        about[f"snap_{way}"] = at, _attributes(f"{stroke} of the first snap while {way}", unit)
    for way, count in zip(("loading", "unloading"), outcome.snaps, strict=True):
        about[f"snaps_{way}"] = count, _attributes(f"steps that snap while {way}", "1")
    notes = {"k_r_N": scale, "k_r_of": staying}
    words = "smallest gap between two F0 or two F1, over k r"
    about["margin"] = outcome.gap / scale, _attributes(words, "1") | notes
    about["monostable"] = outcome.monostable, _attributes(f"{turned} is stable in one state only")
    about["degenerate"] = outcome.degenerate, _attributes("design on a boundary: a tie decides")
    shape = (len(axes[1][1]), len(axes[0][1]))
    # This gives all datasets the accessor `.stepwell`.
    if not hasattr(xr.Dataset, "stepwell"):
        xr.register_dataset_accessor("stepwell")(MapView)
    return xr.Dataset(
        {name: (("y", "x"), field.reshape(shape), notes) for name, (field, notes) in about.items()},
        coords={
            letter: (letter, values, {"long_name": one.name, "units": one.unit})
            for letter, (one, values) in zip("xy", axes, strict=True)
        },
        attrs={
            "title": chain.title or "transition map",
            "moved_cell": turned,
            "chain": repr(chain),
            "closed_form_designs": sequence.size - asked,
            "engine_designs": asked - impossible,
            "impossible_designs": impossible,
            "unsolved_designs": unsolved,
            "assumptions": (
                "quasi-static cycle from all cells at 0 to all at 1 and back; overdamped snaps at "
                "fixed stroke, each cell with its mobility; closed form only where all cells are "
                "proved taut with falling force, are two or share one full travel, and the "
                "actuator is rigid, the general engine elsewhere"
            ),
            "source": f"stepwell {base.__version__}, parameter_map",
        },
    )


def _attributes(name: str, unit: str = "") -> _Attributes:
    notes: _Attributes = {"long_name": name}
    return notes | ({"units": unit} if unit else {})


def _flags(words: list[str], kind: type[np.signedinteger]) -> _Attributes:
    return {
        "flag_values": np.array([*range(len(words)), IMPOSSIBLE, UNSOLVED], kind),
        "flag_meanings": " ".join([*words, "impossible", "unsolved"]),
    }
