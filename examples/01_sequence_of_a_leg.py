"""Two cells in series and one actuator: the end forces of the bands decide what moves when."""

import stepwell as sw

inner = sw.Cell(sw.Band(p=(-0.010, 0.0), q=(0.010, 0.0)), name="inner")
outer = sw.Cell(sw.Band(p=(-0.010, 0.0), q=(0.020, 0.0)), name="outer")
leg = sw.Chain((inner, outer))

# Cells load in ascending order of F0, and unload in descending order of F1.
for cell in leg.levers:
    print(f"{cell.name}: F0 = {cell.force_0:+.4f} N, F1 = {cell.force_1:+.4f} N")

cycle = leg.cycle()
print(cycle.sequence, "is", cycle.pathway)
for event in cycle.events:
    print(event)

snap = cycle.snaps[0]
snap_mm = snap.stroke * 1e3
print(f"The first snap comes at {snap_mm:.4f} mm of {leg.full_stroke * 1e3:.0f} mm")
