"""Datasets and their journals: checked against each other, data files made anew."""
