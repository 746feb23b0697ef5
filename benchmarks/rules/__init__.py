"""Rules as users of answer set programming try them: bound in runs of examples, or refused with a reason.

Modules in reading order:

track     where the robot was and where things lay in a run
tried     the rules, and how a track shows that each was kept
__main__  runs them and prints a table
"""
