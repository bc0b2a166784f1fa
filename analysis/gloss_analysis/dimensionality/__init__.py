"""How many dimensions: the stress curve, beside chance and beside the prediction of judgements left out."""
