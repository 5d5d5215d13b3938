"""What is left of an error that nothing expected: one line, and a file to report it with."""

from stepwell.crash.report import leave, reported
