"""The prompt of `utak repl`: step back and forth through a run or an episode, ask, and change what counts.

Modules in reading order:

loop        reads statements and has them executed; survives every input
statements  lines become statements: a query goes on to its full stop
reading     the sources of lines: a pipe, readline, prompt_toolkit; the history
completion  what can come next at the cursor
dialogue    the state of a conversation, and the execution of one statement
commands    the table of commands, and the small ones
travelling  step, back, run, goto, diff
asking      queries, `;`, facts, since
changing    assume, retract, goal, save
explaining  why, whynot
picture     the believed map as a picture
printer      what is printed: tables, pages, colours

Public names: `converse`, `Dialogue`, `draw_belief`.
"""
