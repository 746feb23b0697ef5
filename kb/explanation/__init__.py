"""Why a decision of an encoding is as it is: proofs, and the least change with which it would be otherwise.

Modules in reading order:

values     what explanations are made of
programs   encodings with their rules' sentences and users' rules; who is asked about them
support    which rule instance derives each atom, such that no atom rests on itself
wording    claims in plain words
rivals     the other ways to choose, held against an answer
tree       proof trees built from rule instances
proof      why an atom holds
whynot     why an atom does not hold
belief     why a predicate that users' rules define for queries holds
query_absence  why such an atom does not hold

Public names: `explain_decision`, `explain_absence`, `explain_query_atom`, `explain_query_absence`.
"""
