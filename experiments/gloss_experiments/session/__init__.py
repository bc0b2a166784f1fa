"""One session: its state machine, its journal, running and resuming it, publishing its data."""
