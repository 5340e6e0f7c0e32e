"""Benchmarks: suites registered by name, each measured side by side in one run."""
