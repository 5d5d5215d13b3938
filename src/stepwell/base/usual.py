"""What is taken where nobody says otherwise: tolerances, reaches, sizes of samples."""

# What a careful workshop with a bag of rubber bands can do: every anchor within this radius [m],
# and the standard deviation of a band's stiffness over its mean [1].
ANCHOR = 0.0003
STIFFNESS = 0.05
# How far an anchor is moved to see what changes [m].
REACH = 0.020
# Mechanisms made for a yield: judged by their end forces, or followed one by one by the engine.
QUICKLY, ONE_BY_ONE = 100_000, 500
