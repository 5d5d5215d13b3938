"""The branches a chain can stand on, and the relays that concave cells are."""
