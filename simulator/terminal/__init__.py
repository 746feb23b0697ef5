"""The terminal: what users type and see.

Modules in reading order:

exits            exit codes
streams          output without control characters; errors of streams
numbers          numbers on the command line
printing         JSON output
action_in_words  an action as text
outcome          one of several things to do, with its exit code
progress         how much of long work is done, and how long the rest takes
"""
