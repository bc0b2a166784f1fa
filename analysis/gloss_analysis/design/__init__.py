"""Design help: how many observers, pairs and repeats a study needs, and which pairs to drop when time is short."""
