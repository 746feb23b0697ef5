"""Episodes: the record of a run as JSON lines, and the files that are written.

Modules in reading order:

episode       reading and writing an episode
record        scenario, commands and motions as values of an episode's lines
wellformed    the check of every value in an episode
output_files  opening files for writing without overwriting anything else

Public names: `Episode`, `EpisodeLog`, `read_episode`.
"""
