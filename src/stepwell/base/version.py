"""The version of Stepwell, defined only here, and the versions of its numerical packages."""

__version__ = "0.1.0"


def versions(*packages: str) -> dict[str, str]:
    """Versions of Python, NumPy, SciPy, Numba and these packages, by name in this order."""
    import platform
    from importlib.metadata import version

    names = ("numpy", "scipy", "numba", *packages)
    return {"python": platform.python_version()} | {name: version(name) for name in names}
