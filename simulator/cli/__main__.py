"""The entry point of `python -m simulator.cli`, which runs the `utak` command."""

import sys

from simulator.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
