"""What a chain does as its actuator moves."""
