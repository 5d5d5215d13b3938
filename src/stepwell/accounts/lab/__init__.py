"""Accounts of recordings and of the results of their analysis."""
