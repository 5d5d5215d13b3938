"""The door of a map: what `map.stepwell` offers of an xarray Dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.base import Drawn, Shown

if TYPE_CHECKING:
    import xarray as xr


class MapView(Shown, Drawn):
    """A map to look at: `map.stepwell` is a card in a notebook, `map.stepwell.plot()` a figure.

    Args:
        dataset: what `transition_map` or `parameter_map` returns.
    """

    def __init__(self, dataset: xr.Dataset):
        self.dataset = dataset

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
