"""Pages that tell results to people, one HTML file each that is complete in itself."""

from stepwell.reports.pages.atlas import atlas_page
from stepwell.reports.pages.parts import image_of
from stepwell.reports.pages.studies import study_page
