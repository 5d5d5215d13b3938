"""The version of Stepwell, written here and nowhere else, and those of what it computes with."""

__version__ = "0.1.0"


def versions(*packages: str) -> dict[str, str]:
    """What a result was computed with.

    Args:
        packages: besides NumPy, SciPy and Numba.

    Returns:
        Name to version: Python first, then the packages.
    """
    import platform
    from importlib.metadata import version

    names = ("numpy", "scipy", "numba", *packages)
    return {"python": platform.python_version()} | {name: version(name) for name in names}
