"""Answer set programming: encodings, users' rules and queries, solved with clingo.

Modules in reading order:

encodings     where encodings lie, their files, text and constants
solver        one answer of our encodings to facts, or none
sentences     the plain sentences of rules, in comments before them
worker        a separate process for programs of users; can be killed
query         queries over the facts of the world model
query_worker  the program that the separate process runs
interfaces    the predicates that users' rules may use in each encoding
rulebook      users' rules checked against these predicates
user_rules    reading, testing and solving with users' rules
sentences     plain sentences in rule files: why a rule holds, how a predicate reads
assumptions   facts and rules that a user adds while the robot runs
rule_reader   rule files parsed to statements, in the separate process
rule_solver   encodings solved with users' rules, in the separate process

Public names: `solve`, `QueryEngine`, `read_rules`, `read_tested_rules`, `read_assumptions`.
"""
