"""What a robot will do, from statics alone."""
