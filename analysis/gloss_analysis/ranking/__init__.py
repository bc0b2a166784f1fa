"""Ranking studies: agreement with a predicted order, and among participants."""
