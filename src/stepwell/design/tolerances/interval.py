"""How sure a count of successes is."""


def interval_95(successes: int, n: int) -> tuple[float, float]:
    """95 % confidence interval of a probability (Clopper & Pearson 1934)."""
    from scipy.stats import binomtest

    found = binomtest(successes, n).proportion_ci(0.95, "exact")
    return float(found.low), float(found.high)
