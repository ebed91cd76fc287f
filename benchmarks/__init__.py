"""Measurements, each side by side with a peer or with the version before: `python -m benchmarks`."""
