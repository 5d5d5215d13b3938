"""A walk as an xarray Dataset, every variable with its unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import Quantity, Schema, __version__, variables

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.simulation.runs.walk import Walk

_MEAN = "mean since the sample before"
_CARRIED = f"that the floor carries, {_MEAN}"
SAMPLES: Schema = (
    Quantity("x", "mm", doc="body's origin, along the start's x axis"),
    Quantity("y", "mm", doc="body's origin, to the left"),
    Quantity("z", "mm", doc="body's origin, above the floor"),
    Quantity("yaw", "deg", doc="heading"),
    Quantity("pitch", "deg", doc="nose down"),
    Quantity("roll", "deg", doc="right side down"),
    Quantity("command", "mm", doc="stroke wanted"),
    Quantity("stroke", "mm", doc="stroke reached"),
    Quantity("actuator_force", "N", doc="that pushes the outermost blocks out"),
    Quantity("travel", "mm", doc="of each cell", dims=("leg", "cell")),
    Quantity("foot_height", "mm", doc="lowest point above the floor", dims=("leg",)),
    Quantity("foot_force", "N", doc=_CARRIED, dims=("leg",)),
    Quantity("foot_speed", "mm_s", doc="along the floor", dims=("leg",)),
    Quantity("support_force", "N", doc=_CARRIED, dims=("support",)),
    Quantity("antenna", "deg", doc="rotation from rest", dims=("antennas",)),
    Quantity("touch", "N", doc=f"of what touches the antenna, {_MEAN}", dims=("antennas",)),
    Quantity("obstacle_force", "N", doc=f"on each obstacle, {_MEAN}", dims=("obstacle",)),
)


def dataset(walk: Walk) -> xr.Dataset:
    """The samples of a walk, named and with units."""
    import xarray as xr

    coordinates = {
        "time": ("time", walk.time, {"units": "s", "long_name": "from the first cycle's start"}),
        "leg": [leg.name for leg in walk.robot.legs],
        "support": np.arange(1, walk.support_force.shape[1] + 1),
        "antennas": np.array([antenna.name for antenna in walk.robot.antennas], dtype=str),
    }
    attributes = {
        "title": walk.robot.title,
        "stepwell": __version__,
        "stopped": walk.stopped,
        "time_step_s": walk.settings.time_step,
        "integrator": str(walk.settings.integrator),
        "linkage": str(walk.settings.linkage),
    }
    return xr.Dataset(variables(SAMPLES, walk, "time"), coordinates, attributes)


def without_empty(data: xr.Dataset) -> xr.Dataset:
    """The samples without what a robot or an arena has none of."""
    # Readers of NetCDF 3 take a dimension of length 0 for an unlimited one and stumble.
    return data.drop_dims(
        [name for name, size in data.sizes.items() if not size and name != "time"]
    )
