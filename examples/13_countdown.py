"""A chain that counts: the same pull moves it one on, three times, and then no more."""

import stepwell as sw

counter = sw.preset("countdown")
shown = []
for pulls in range(6):
    end = counter.path([0.040, *[0.068, 0.040] * pulls], start="01001").end
    shown.append("".join("1" if travel > 0.010 else "0" for travel in end))
print(" > ".join(shown))
counts = len(set(shown)) - 1
