"""The planner: from the task and what is believed to the next command. Imports geometry and kb.

cycle         the action cycle: wake, then act, perceive and decide until the task ends
decision      a decision: the next command, or the verdict
stages        the stages of a task
constraints   regions that are kept off, and what a thing sweeps
per_model     answers that depend on a world model, computed once for it
situation     what a decision depends on: beliefs, cost maps, rooms, what parameters mean
journal       what a step adds to the record of decisions and places
steps         the steps of the robot itself, of which each command is one, and whether they may be done
question      what a decision puts to planner/asp/deciding
advice        what the plan executor advises
subgoal_kind  the kinds of subgoals
under_way     what is being planned, in words
agenda        which activity comes next for a stage, and with which verdict the robot gives up (a room)
deciding      how each activity is done (a room)
tasking       the task plan: what is brought where, in which order (a room)
oracles       questions to geometry about states that plans lead to (a room)
carrying      manipulation plans and their execution (a room)
skills        commands where no plan gives them (a room)
goals         where goals hold (a room)
navigation    subgoals and routes of the robot (a room)
sights        viewpoints (a room)
screen        cost maps and straight moves (a room)

Public names: Robot, Options, Decision, TaskVerdict, Situation, Stage, SubgoalKind.
"""
