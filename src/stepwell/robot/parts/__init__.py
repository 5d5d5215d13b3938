"""What a robot is made of, and where it is put: values only."""
