"""Judged pairs, where they come from, and how far they can be trusted."""
