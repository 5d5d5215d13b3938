"""A story in seven steps of what springs can be told to do, and the page that shows it moving."""
