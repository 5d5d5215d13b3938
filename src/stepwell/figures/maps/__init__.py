"""Maps over parameters, yields, and what counts most."""
