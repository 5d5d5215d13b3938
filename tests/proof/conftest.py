"""Proofs are tested where the extra `proof`, python-flint, is installed."""

from stepwell.base import have

collect_ignore_glob = [] if have("proof") else ["test_*.py"]
