"""One verdict on a design: whether the real one will do what is wanted."""

from stepwell.design.checks.check import Check, check
from stepwell.design.checks.measurement import Measurement
from stepwell.design.checks.verdict import Verdict, judged
