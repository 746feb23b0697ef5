"""The command `utak`.

Modules in reading order:

main      runs a subcommand; errors become messages and exit codes
parsing   the parser of the command line
__main__  the same, as `python -m utak.simulator.cli`
commands  the subcommands, one a module
"""
