"""Millimetres and degrees of a design file, to and from SI, exact to the last bit.

A file holds decimals. The decimal point is moved in the decimal, and only the result is
rounded to a float, once. So 10 mm is the float 0.01 and not its neighbour, and every float
in metres has a decimal in millimetres that reads back as the same float.
"""

from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal

# More digits than a float can have (767), so that moving the point never rounds.
_EXACT = Context(prec=800, Emax=MAX_EMAX, Emin=MIN_EMIN, traps=[])
_ENOUGH = Context(prec=60, Emax=MAX_EMAX, Emin=MIN_EMIN, traps=[])
_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


def moved(number: Decimal, places: int) -> float:
    """The float nearest to `number` with its decimal point moved: -3 for mm to m."""
    return float(_EXACT.scaleb(number, places))


def shortest(value: float, places: int = 0) -> Decimal:
    """The shortest decimal that `moved(..., -places)` reads back as `value`: 3 for m to mm."""
    return _EXACT.scaleb(Decimal(repr(float(value))), places)


def radians(degrees: Decimal) -> float:
    """The float nearest to an angle in rad; 45 gives `math.pi / 4` exactly."""
    return float(_ENOUGH.divide(_ENOUGH.multiply(degrees, _PI), Decimal(180)))


def degrees(angle: float) -> Decimal:
    """The shortest decimal in degrees that `radians` reads back as `angle`."""
    exact = _ENOUGH.divide(_ENOUGH.multiply(Decimal(angle), Decimal(180)), _PI)
    # A float has 17 digits; the angle in degrees needs at most one more.
    candidates = (Context(prec=digits).plus(exact) for digits in range(1, 20))
    return next(candidate for candidate in candidates if radians(candidate) == angle)


def toml(number: Decimal) -> str:
    """A decimal as TOML writes it: an integer where it is one, plain where that is short."""
    number = number.normalize(_EXACT)
    if number.is_zero():
        return "-0.0" if number.is_signed() else "0"
    if not -7 < number.adjusted() < 15:
        return format(number, "e")
    return format(number, "f")
