"""Following the local minimum event by event: compiled kernels, and what they keep."""
