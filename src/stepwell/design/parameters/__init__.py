"""The parameters of a chain by name."""

from stepwell.design.parameters.parameter import WAY, Knob, knob, knobs

__all__ = ["WAY", "Knob", "knob", "knobs"]
