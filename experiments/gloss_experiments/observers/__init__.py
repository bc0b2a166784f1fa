"""Simulated observers: programs that answer."""
