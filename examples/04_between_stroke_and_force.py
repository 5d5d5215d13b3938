"""A spring before the actuator: the softer it is, the more of the cycle happens in snaps."""

import math
from dataclasses import replace

import stepwell as sw

leg = sw.preset("paper-forward")
heat_mJ = {}
print("K [N/m]   snaps   heat [mJ]   sequence")
for stiffness in (math.inf, 400.0, 100.0, 40.0, 5.0, 0.0):
    cycle = replace(leg, actuator_stiffness=stiffness).cycle()
    heat_mJ[stiffness] = cycle.dissipated * 1e3
    print(f"{stiffness:7g}   {len(cycle.snaps):5d}   {heat_mJ[stiffness]:9.4f}   {cycle.sequence}")

# At K = 0 every cell is a relay that switches on at F0 and off at F1, by itself: it turns its
# loop (F0 - F1) S into heat, and nothing of the neighbours enters.
relays_mJ = sum((c.force_0 - c.force_1) * c.full_travel for c in leg.cells) * 1e3
print(f"Relays with switching forces F0 and F1 lose {relays_mJ:.4f} mJ")
