"""Accounts of robots: as designed, walking, compiled, and of hoppers that jump."""
