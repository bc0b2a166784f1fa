"""`gloss session`, `gloss dataset`, `gloss calibrate`."""
