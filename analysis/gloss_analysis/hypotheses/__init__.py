"""What an axis could be: candidates, and their tests on ratings and judged pairs."""
