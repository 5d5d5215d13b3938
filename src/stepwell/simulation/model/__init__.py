"""A robot as a MuJoCo model."""
