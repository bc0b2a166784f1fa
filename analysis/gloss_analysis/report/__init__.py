"""The report of a study: one HTML file that opens anywhere, and its figures, tables and text as files for a paper.

`write_report` is the whole public surface; each module behind it holds one concept.
"""

from gloss_analysis.report.page import WrittenReport, write_report

__all__ = ["WrittenReport", "write_report"]
