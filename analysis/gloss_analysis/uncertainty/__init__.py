"""How firmly judgements fix a solution: bootstrap and jackknife."""
