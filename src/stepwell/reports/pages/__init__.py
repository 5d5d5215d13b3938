"""Pages that tell results to people, one HTML file each that is complete in itself."""

from stepwell.reports.pages.run import report
