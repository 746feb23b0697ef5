"""The command `utak`.

Modules in reading order:

main      runs a subcommand; errors become messages and exit codes
table     the subcommands and their arguments
parsing   the parser of the command line, made from the table
__main__  the same, as `python -m utak.simulator.cli`
commands  the subcommands, one a module
"""
