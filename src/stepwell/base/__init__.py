"""What every room stands on: equality and checks of values, limits, text, files written whole."""
