"""Accounts of recordings and of what they show."""
