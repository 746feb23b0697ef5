"""Logic programs made to tell how their answers come about: instances of rules, costs, and what would change an answer.

Everything here works on texts and returns JSON values, so that it runs in this process for our own encodings, and in
the separate process of kb.reasoning.query_worker for programs with users' rules.

Modules in reading order:

decisions     the record of what encodings were given and answered
syntax        statements with places for hidden variables; one alternative of each pool
instrument    helping rules that make clingo say which instances of rules hold
answers       programs grounded once: whole answers, instances, best answers under assumptions
alternatives  what a choice would have cost otherwise, or which constraints forbid it
calculations  arithmetic of rules as functions, and where they turn
domains       the values that arguments may have: known ones, and numbers that rules need
candidates    facts that might be given besides, so that an atom holds
switches      programs whose facts can be taken away or given besides
changes       the smallest changes of the facts that make an atom hold
possible_worlds  answer sets weighed: exact chances by independent components, and the likeliest worlds
requests      all of this as requests and responses of JSON values

Public names: `respond`, `ProgramPart`.
"""
