"""Commands that compute many designs."""
