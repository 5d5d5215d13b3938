"""Reports of unexpected errors: one line on the terminal, and a file to attach."""

from stepwell.crash.report import leave, reported
