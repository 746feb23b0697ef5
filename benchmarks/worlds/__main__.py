"""Writes random worlds: python -m benchmarks.worlds (see benchmarks.worlds.makers)."""

from benchmarks.worlds.makers import main

if __name__ == "__main__":
    main()
