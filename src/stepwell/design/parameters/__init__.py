"""The parameters of a chain by name."""

from stepwell.design.parameters.parameter import WAY, Parameter, of_cell, parameter, parameters
