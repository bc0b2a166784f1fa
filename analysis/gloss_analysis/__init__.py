"""Finds the gloss space: scaling, confirmatory analysis, regression of ratings, and the report of a study."""
