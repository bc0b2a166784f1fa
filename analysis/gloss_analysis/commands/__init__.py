"""Sub-commands of the analysis. Science is imported inside the functions: `gloss --help` should not wait for it."""
