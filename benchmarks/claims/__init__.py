"""A campaign that refutes claims: what the robot calls done must be done, what it calls impossible must be impossible.

Modules, in reading order:

asked     which worlds are asked for, and what is known of them
child     one run in a process of its own
refute    claims against the truth
row       the result of one world
run       one world from its folder to its row
table     the table of all results
report    a page about the worlds that went wrong
true_facts  a program of its own: facts that are stated as known and contradict the table
__main__  the program
"""
