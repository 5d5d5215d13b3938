"""Claims of others about chains of bistable elements."""
