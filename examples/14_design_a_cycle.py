"""Anchors for a wanted cycle on a drilled plate, and how many built ones will do it."""

import stepwell as sw

made = sw.design(
    "000>010>011>111>101>001>000",
    holes=0.005,
    tolerances=sw.Tolerances(anchor=0.0003, stiffness=0.05),
)
print(made)
holes_mm = (made.anchors * 1e3).round(6).tolist()
