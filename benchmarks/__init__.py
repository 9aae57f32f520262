"""How fast it is: `python -m benchmarks`, or `python -m benchmarks kernel` for one of them."""
