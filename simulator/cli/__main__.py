"""The entry point of `python -m utak.simulator.cli`, which runs the `utak` command."""

import sys

from utak.simulator.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
