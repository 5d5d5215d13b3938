"""For which mobilities the landing of a snap holds: where it starts, proofs, samples."""

# pyright: reportUnusedImport=false

from stepwell.statics.landings.enclosure import enclosed
from stepwell.statics.landings.energy import energy_holds
from stepwell.statics.landings.freedom import goes_one_way
from stepwell.statics.landings.sampling import corners_of, factors_of, land_all
from stepwell.statics.landings.start import Snap, snaps_of
