"""Accounts of builds: of a chain and of a robot."""
