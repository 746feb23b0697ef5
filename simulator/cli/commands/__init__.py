"""The subcommands of `utak`, one a module: `add` declares it, `execute` does it and returns the exit code."""
