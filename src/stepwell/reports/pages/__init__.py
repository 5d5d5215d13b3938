"""Pages that tell results to people, one HTML file each that is complete in itself."""

from stepwell.reports.pages.as_built import as_built_page
from stepwell.reports.pages.atlas import atlas_page
from stepwell.reports.pages.measured import (
    band_page,
    calibration_page,
    comparison_page,
    readings_page,
)
from stepwell.reports.pages.parts import image_of
from stepwell.reports.pages.studies import study_page
