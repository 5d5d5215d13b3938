"""The keys of design files: what each may hold, and in which unit."""
