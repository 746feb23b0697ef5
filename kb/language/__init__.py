"""The language of the files that users write: reading, checking, and messages about errors.

Modules in reading order:

diagnostics       problems in users' files: place, message, hint
source_text       the text of a file, read safely and checked to be ASCII
tokens            tokens of a fact file
terms             facts and terms as values
atoms             atoms as text, taken apart
reader            the reader of fact files
wkt               the reader of shapes (well-known text)
arguments         argument types: checks of single terms
goal_words        the conditions that goals state, one row for each
vocabulary        the predicates of each kind of fact file and of the world model
integers          the check for integers beyond 32 bits
operating_system  process limits, file locks and other features that some systems lack

Public names: `read_facts`, `parse_facts`, `facts_from_text`, `parse_wkt`, `check_facts`, `BadInputError`,
`CannotOpenError`.
"""
