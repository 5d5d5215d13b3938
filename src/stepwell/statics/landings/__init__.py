"""For which mobilities the landing of a snap holds: where it starts, proofs, samples."""
