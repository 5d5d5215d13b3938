"""Sorted forces give the order of three cells, but not which of them is left half way."""

import stepwell as sw


def cell(name: str, dx_mm: float, dy_mm: float, stiffness: float) -> sw.Cell:
    """The paper's cell with another band, its anchors dx and dy apart."""
    band = sw.Band(p=(0.0, 0.0), q=(dx_mm * 1e-3, dy_mm * 1e-3), stiffness=stiffness)
    return sw.Cell(band, name=name)


chain = sw.Chain(
    (
        cell("a", 9.405, 2.068, 53.935),
        cell("b", 18.983, -8.699, 55.823),
        cell("c", 8.011, -10.351, 15.018),
    )
)
cycle = chain.cycle()
print(cycle.sequence)

# While b loads, it snaps at the force at which c lets go, since F1 of c is the largest. But a
# gives travel back too, its force rises faster than that of c, and a is what stays half way.
# A second snap, of a with c, puts that right.
loading = [event for event in cycle.events if event.direction > 0]
for event in loading:
    print(event)

second_mm = loading[-2].stroke * 1e3
print(f"The second snap of the stroke of b comes at {second_mm:.4f} mm")
