"""Episodes: the record of a run as JSON lines, and the files that are written.

Modules in reading order:

episode       reading and writing an episode
record        scenario, commands and motions as values of an episode's lines
schema        the JSON Schema of episodes and of what commands print under --json, and the check by it
program_dump  the decisions of an episode as programs for plain clingo
output_files  opening files for writing without overwriting anything else

Public names: `Episode`, `EpisodeLog`, `read_episode`.
"""
