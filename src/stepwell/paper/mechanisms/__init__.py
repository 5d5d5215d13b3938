"""Claims about unit cells and chains."""
