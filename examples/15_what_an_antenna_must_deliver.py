"""How far, and how hard, an anchor has to be pushed before a leg walks backward."""

import stepwell as sw

leg = sw.preset("paper-forward")
pushed = leg.reprogram("00>01>11>10>00", by="inner.p", along=(-1, 0))
print(pushed)
# Band and levers differ only in d_x, so the two cells trade places where their d_x agree.
distance_mm = pushed.distance * 1e3
