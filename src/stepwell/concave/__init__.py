"""The closed form of concave cells, where it is proved: certificates, end forces, sorting."""
