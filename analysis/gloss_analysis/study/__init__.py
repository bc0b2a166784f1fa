"""The gloss paper's study: its folder, its analysis, its numbers beside the paper's."""
