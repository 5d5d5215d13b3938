"""The door of a map: what `map.stepwell` offers of an xarray Dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from stepwell.base import Drawn, Shown

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.design.plane import Boundary


class MapView(Shown, Drawn):
    """A map to look at: `map.stepwell` is a card in a notebook, `map.stepwell.plot()` a figure.

    Args:
        dataset: what `transition_map` or `parameter_map` returns.
        boundaries: what `boundaries` or `parameter_boundaries` returns for the same axes.
        designs: both parameters in SI of each design that is marked, by name; the first is the one
            that was asked about.
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


def with_door(dataset: xr.Dataset) -> xr.Dataset:
    """The same dataset; from now on this and all others have `.stepwell`."""
    import xarray as xr

    if not hasattr(xr.Dataset, "stepwell"):
        xr.register_dataset_accessor("stepwell")(MapView)
    return dataset
