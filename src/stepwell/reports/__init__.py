"""Folders of results: figures, tables, numbers and pages that belong together."""
