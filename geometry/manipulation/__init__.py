"""Manipulation: how the robot brings a body to a goal by grasping, pushing and turning it.

Modules, in reading order:

goals  What a goal of carrying is, whether it is reached, and what each end pose costs.
workspace  Free squares and the walls around them, ready for exact first contact.
legs  Legs of a plan: walk, grasp, push and turn, release.
query  A manipulation query: body, workspace, robot, goal, wishes.
grasps  Places from which the robot can grasp the body, and their order.
plan_carrying  The public call: which planners are tried, in which order.
lattice_planner  Planning by whole squares and quarter turns.
extract_legs  From the nodes of a lattice search to legs with few pushes.
press  The last push made longer, into a corner.
align  A first leg that lays the body along the axes.
free_body  The motion of the body alone: a proof when it cannot pass.
single_grasp  Planning at any place and angle with one grasp.

Public names: `plan_carrying`, `CarryingPlan`, `Leg`, `At`, `Inside`, `InCorner`, `Between`, `Workspace`.
"""
