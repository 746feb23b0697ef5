"""Queries and users' rules over incomplete knowledge: what certainly holds, and what may hold, joined by clingo.

Modules in reading order:

arithmetic   exact integer arithmetic with 32-bit results
values       values of which only bounds are known, their comparison, and aggregates of them
open_world   the believed facts, and the facts that may hold besides
compilation  bodies as clingo joins them, once for what is certain and once for what may be
functions    what clingo asks while it joins: rows, comparisons and calculations of values
evaluation   what rules derive, what queries find, and the rule instances of which explanations are made
aliases      `utak` in queries, which facts call `org`
known_words  the check of predicates and constants in queries

Public names: `Beliefs`, `Evaluation`, `check_body`, `rename_utak_to_org`.
"""
