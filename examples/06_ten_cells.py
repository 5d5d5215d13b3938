"""Ten cells, any order up and any order down: two sorted lists of forces give the sequence."""

import numpy as np

import stepwell as sw

# Anchors spread by the golden ratio, so that no two cells have nearly the same forces.
spread = [(0.002 + 0.018 * i / 9, 0.020 * ((0.618034 * i) % 1.0 - 0.5)) for i in range(10)]
chain = sw.Chain(tuple(sw.Cell(sw.Band(p=(-0.010, 0.0), q=q)) for q in spread))

cycle = chain.cycle()
by_force_0 = np.argsort([cell.force_0 for cell in chain.levers])
by_force_1 = np.argsort([-cell.force_1 for cell in chain.levers])
print("loads  ", cycle.loading_order, "ascending F0: ", tuple(by_force_0.tolist()))
print("unloads", cycle.unloading_order, "descending F1:", tuple(by_force_1.tolist()))
print(f"{len(cycle.snaps)} snaps turn {cycle.dissipated * 1e3:.3f} mJ into heat")

nearest = float(np.min(sw.margin(chain).anchors)) * 1e3
print(f"The nearest other sequence is {nearest:.3f} mm of one anchor away")

heat_mJ = cycle.dissipated * 1e3
