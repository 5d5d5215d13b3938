"""Mechanisms as a workshop makes them: tolerances, yields, the survival of programs."""
