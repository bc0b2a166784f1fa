"""The front door: runs the rooms one after the other. It calls their public functions and owns no science."""
