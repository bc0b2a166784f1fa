"""Axis functions: their forms, fitted to ratings, and where stimuli lie along them."""
