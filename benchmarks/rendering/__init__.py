"""Parts of `benchmarks/render.py`: the methods it compares, and what it says of them."""
