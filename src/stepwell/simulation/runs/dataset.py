"""A walk as an xarray Dataset, every variable with its unit."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import __version__, write_atomic

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.simulation.runs.walk import Walk

VARIABLES = {
    "x": ("m", "body's origin, along the start's x axis", ()),
    "y": ("m", "body's origin, to the left", ()),
    "z": ("m", "body's origin, above the floor", ()),
    "yaw": ("rad", "heading", ()),
    "pitch": ("rad", "nose down", ()),
    "roll": ("rad", "right side down", ()),
    "command": ("m", "stroke wanted", ()),
    "stroke": ("m", "stroke reached", ()),
    "actuator_force": ("N", "that pushes the outermost blocks out", ()),
    "travel": ("m", "of each cell", ("leg", "cell")),
    "foot_height": ("m", "lowest point above the floor", ("leg",)),
    "foot_force": ("N", "that the floor carries, mean since the sample before", ("leg",)),
    "foot_speed": ("m/s", "along the floor", ("leg",)),
    "support_force": ("N", "that the floor carries, mean since the sample before", ("support",)),
    "antenna": ("rad", "rotation from rest", ("antennas",)),
    "touch": ("N", "of what touches the antenna, mean since the sample before", ("antennas",)),
    "obstacle_force": ("N", "on each obstacle, mean since the sample before", ("obstacle",)),
}


def dataset(walk: Walk) -> xr.Dataset:
    """The samples of a walk, named and with units."""
    import xarray as xr

    variables = {
        name: xr.Variable(("time", *dims), getattr(walk, name), {"units": unit, "long_name": words})
        for name, (unit, words, dims) in VARIABLES.items()
    }
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
    return xr.Dataset(variables, coordinates, attributes)


def write_netcdf(data: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write as NetCDF; the file appears whole or not at all.

    What a robot or an arena has none of is left out.
    """
    # Readers of NetCDF 3 take a dimension of length 0 for an unlimited one and stumble.
    none = [name for name, size in data.sizes.items() if size == 0 and name != "time"]
    data = data.drop_dims(none)
    write_atomic(path, bytes(data.to_netcdf(engine="scipy")))
