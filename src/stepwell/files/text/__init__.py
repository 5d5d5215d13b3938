"""The text of design files: TOML, key paths, units, errors."""
