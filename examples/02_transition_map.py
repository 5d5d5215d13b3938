"""Moving one anchor reaches all four pathways: the transition map says which one where."""

import numpy as np

import stepwell as sw

leg = sw.preset("paper-forward")
x, y = np.linspace(0.0, 0.020, 200), np.linspace(-0.015, 0.015, 200)
found = sw.transition_map(leg, "outer", x=x, y=y)

shares = {
    pathway: float(np.mean(found.pathway == code))
    for code, pathway in enumerate(sw.Pathway)
    if pathway is not sw.Pathway.OTHER
}
for pathway, share in shares.items():
    print(f"{pathway.label:<18}{share:6.1%} of the anchors")

clockwise_share = shares[sw.Pathway.CLOCKWISE]
