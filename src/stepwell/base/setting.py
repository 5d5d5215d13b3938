"""What the environment sets, where it cannot be understood."""


class SettingError(ValueError):
    """An environment variable of Stepwell's says something that is none of its settings."""
