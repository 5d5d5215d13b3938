"""Recordings of test machines: read, named, looked at for oddities, averaged."""
