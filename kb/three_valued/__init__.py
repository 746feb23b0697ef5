"""Three-valued evaluation of rule bodies over incomplete knowledge: true, false, or not known.

Modules in reading order:

clauses           rules as values, translated from clingo's syntax trees
uncertain_values  values and their comparison where one is not known
arithmetic        exact integer arithmetic with 32-bit results
open_world        the believed facts, and the facts that may hold besides
join_order        the order in which the literals of a body are evaluated
term_values       the values of terms whose variables are bound
evaluation        the bindings with which a body holds or may hold
aggregates        the value of an aggregate with uncertain elements
derivation        atoms that rules derive from the believed facts
provenance        which rule instances derive the certain atoms
aliases           `utak` in queries, which facts call `org`
known_words       the check of predicates and constants in queries and rules

Public names: `translate_rule`, `Beliefs`, `find_bindings`, `derive`, `check_body`.
"""
