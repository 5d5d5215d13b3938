"""What all commands do on the screen: tables, progress, errors."""
