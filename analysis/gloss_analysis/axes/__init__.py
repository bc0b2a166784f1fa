"""What the dimensions of a solution mean, in which conventions it is shown, and how well two solutions agree."""
