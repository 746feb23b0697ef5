"""The subcommands of `utak` that read and write files of scenarios or check them, and run nothing.

check            check the files of scenarios
show             print a world as a picture
new              write a small scenario
import_scenario  write the scenario of a file of another format
verify           check a certificate against its episode
"""
