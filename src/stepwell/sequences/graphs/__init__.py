"""The transition graph of a chain, and graphs as files of other programs."""
