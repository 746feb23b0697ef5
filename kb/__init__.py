"""The knowledge of the robot: perception, localisation, the map, the world model and the task. Imports geometry alone.

Modules and rooms in reading order:

body          the commands and the impression: the only way from the mind to the world
knowledge     the pipeline from one impression to the next world model, on one page
perception    regions of the retina and of the map, and what they are
localisation  what happened after a command: hypotheses, their scores, the choice
mapping       which squares are occupied, by the counts of all impressions; completions
objects       shape, extent and place of objects; touches
world         the world model, rooms, doors and corners; the same as facts
task          the task, and the binding of its parameters to objects
language      fact files: reading, checking, vocabulary
reasoning     clingo, queries, rules of users
tracing       logic programs made to say how their answers come about
explanation   proofs of answers, and what would change them
evidence      why facts, cells, commands and verdicts are as they are, down to cells of impressions
three_valued  queries whose answer may be `don't know`
asp           the encodings, one concern a file

Public names: `Body`, `Command`, `Impression` (body); `Knowledge` (knowledge); `WorldModel` (world.model).
"""
