"""The check of the screen before a session."""
