"""Confirmatory scaling: given axes, estimated weights, and whether the axes hold."""
