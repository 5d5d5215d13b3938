"""What the page asks the other way round: maps of parameters, wishes, yields."""
