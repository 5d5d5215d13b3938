"""Parts of a whole robot: rails, sliders, Vs, carriage, antennas and the holder of the actuator."""
