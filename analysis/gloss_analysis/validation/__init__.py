"""How well a metric predicts judged differences."""
