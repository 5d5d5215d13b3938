"""Friction delays snaps and reduces the energy that they release; a weight moves all one way."""

from dataclasses import replace

import stepwell as sw

leg = sw.preset("paper-forward")
inner, outer = leg.cells


def show(title: str, chain: sw.Chain) -> sw.Cycle:
    """Print and return a cycle."""
    cycle = chain.cycle()
    strokes = ", ".join(f"{snap.stroke * 1e3:.3f}" for snap in cycle.snaps) or "none"
    path = cycle.path
    print(f"{title:<22} snaps at {strokes:<14} mm; heat in snaps {path.released * 1e3:.4f} mJ,")
    print(f"{'':<22} in friction {path.friction_work * 1e3:.4f} mJ")
    return cycle


show("as designed", leg)
rubbing = [
    show(
        f"{friction * 1e3:g} mN of friction",
        sw.Chain((replace(inner, friction=friction), replace(outer, friction=friction))),
    )
    for friction in (0.02, 0.2)
]
show("50 mN on the outer", sw.Chain((inner, replace(outer, load=sw.Load.constant(0.05)))))

# With 0.2 N no force difference is left to snap: the loop is 2 f wide along two full travels,
# up and down.
friction_mJ = rubbing[-1].path.friction_work * 1e3
