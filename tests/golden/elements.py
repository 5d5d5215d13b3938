"""Design files of elements: forces, pressures and torques, alone and beside a lever cell."""

TRILINEAR = """\
title = "Two trilinear elements"

[[chain.cell]]
name = "soft"
points = { travel_mm = [0, 1, 3, 5], force_N = [0, 1, -0.8, 1.5] }

[[chain.cell]]
name = "stiff"
stops = [true, false]
points = { travel_mm = [0, 1, 3, 5], force_N = [0, 1.2, -0.9, 1.5] }
"""

BALLOONS = """\
title = "Two balloons"

[[chain.cell]]
name = "thin"
table = { volume_mL = [0, 20, 60, 100], pressure_kPa = [0, 2, 1.2, 4] }

[[chain.cell]]
name = "thick"
table = { volume_mL = [0, 20, 60, 100], pressure_kPa = [0, 2.5, 1, 4.5] }

[program]
turning_points_mL = [0, 130, 90]
"""

TWISTING = """\
title = "Two twisting cells on a soft shaft"

[chain]
actuator_stiffness_N_m_per_rad = 0.02

[[chain.cell]]
name = "left"
stops = true
points = { angle_deg = [0, 12, 34, 57], torque_mNm = [0, 2, -1, 4] }

[[chain.cell]]
name = "right"
friction_mNm = 0.1
points = { angle_deg = [0, 12, 34, 57], torque_mNm = [0, 2.5, -1.2, 4] }
"""

MIXED = """\
title = "A lever cell and a dome"

[chain]
lever_mm = 14.142135623730951
limit_deg = 45
band = { stiffness_N_per_m = 28.5, rest_length_mm = 10 }

[[chain.cell]]
name = "lever"
p_mm = [-10, 0]
q_mm = [10, 0]

[[chain.cell]]
name = "dome"
points = { travel_mm = [0, 5, 13, 20], force_N = [0, 0.3, -0.3, 0.5] }
"""

THREE_PHASES = """\
title = "Three phases"

[[chain.cell]]
name = "stairs"
points = { travel_mm = [0, 1, 3, 5, 7, 9], force_N = [0, 1, -1, 1.5, -0.5, 2] }

[[chain.cell]]
name = "step"
points = { travel_mm = [0, 1.1, 3, 5], force_N = [0, 1.2, -0.9, 1.5] }
"""

FOLDED = """\
title = "A curve that folds back"

[[chain.cell]]
name = "snap"
curve = { travel_mm = [0, 3.5, 0.5, 8.75], force_N = [0, 1, -1, 1.5] }
"""

# What one of the two gives as the large one snaps through, the other need not.
RACE = """\
title = "Two that race to give way"

[[chain.cell]]
name = "large"
points = { travel_mm = [0, 6, 17, 21], force_N = [0, 1.3, -0.7, 0.5] }

[[chain.cell]]
name = "left"
points = { travel_mm = [0, 3, 11, 15], force_N = [0, 0.62, 0.24, 1.44] }
mobility = 1.5

[[chain.cell]]
name = "right"
points = { travel_mm = [0, 3, 11, 15], force_N = [0, 0.73, 0.15, 1.35] }
"""

DESIGNS = {
    "trilinear.toml": TRILINEAR,
    "balloons.toml": BALLOONS,
    "twisting.toml": TWISTING,
    "mixed.toml": MIXED,
    "three.toml": THREE_PHASES,
    "folded.toml": FOLDED,
    "race.toml": RACE,
}
