"""Evidence: why a fact is believed, from the record of a run, down to the cells of impressions.

Modules in reading order:

record     the steps of a run as the robot recorded them: commands, impressions, beliefs, decisions
reason     a tree of reasons, as text in three depths and as JSON values
sightings  which cells of which impressions show a square
witness    reasons that are cells: why a square, an outline or a colour is believed
proving    proof trees of encodings as reasons
inputs     reasons for what encodings were given
plans      reasons for the facts of the task plan
beliefs    reasons for the facts of the world model
absences   why facts are not believed: what is missing or in the way
goals      reasons for commands and verdicts
cells      what each of the 160 cells of an impression is laid to

Public names: `Record`, `FactExplainer`, `Reason`, `explain_cell`, `explain_command`, `explain_verdict`.
"""
