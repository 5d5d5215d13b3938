"""What a robot did, or will do."""
