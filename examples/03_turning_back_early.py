"""One actuator is programmed by where it turns: partial strokes reach what full ones do not."""

import stepwell as sw

leg = sw.preset("paper-forward")
snap = leg.cycle().snaps[0]

# From 10 the outer cell loads. Turning back before the snap undoes it, turning back after it
# leaves the outer cell where it is and brings the inner one home.
before = leg.path([0.020, snap.stroke - 0.0001, 0.020], start="10")
past = leg.path([0.020, snap.stroke + 0.0001, 0.020], start="10")


def state(path: sw.Path) -> str:
    """The state at the end of a path that ends at the stops."""
    return "".join("0" if travel == 0 else "1" for travel in path.end)


print(f"The snap is at {snap.stroke * 1e3:.4f} mm")
print(f"turn 0.1 mm before it: 10 > {state(before)}, heat {before.dissipated * 1e3:.4f} mJ")
print(f"turn 0.1 mm after it:  10 > {state(past)}, heat {past.dissipated * 1e3:.4f} mJ")

end_state = state(past)
