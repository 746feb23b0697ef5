"""Episodes: the record of a run as JSON lines, and the files that are written.

Modules in reading order:

episode       reading and writing an episode
record        scenario, commands and motions as values of an episode's lines
forms         forms of JSON values, and the check of a value
wellformed    the forms of an episode's lines
output_forms  the forms of what commands print under --json
json_schema   forms as JSON Schema
program_dump  the decisions of an episode as programs for plain clingo
output_files  opening files for writing without overwriting anything else

Public names: `Episode`, `EpisodeLog`, `read_episode`.
"""
