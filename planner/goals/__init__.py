"""Goals: where a goal of the task holds for the robot or for an object, or what must be known first to tell.

Modules, in reading order:

robot_goals   Destination: the squares on which a goal holds for the robot
bounds        pieces of what bounds the floor on which a goal rests, and which may be things
placement     Placement: where a goal holds for an object
embedded      Supposition: how an object lies if it goes on in a wall
object_goals  the placement that a goal for an object asks for
corner_goal   the placement in a corner
near_goal     the placements beside another object, at the start, and at a pose
optimistic    optimistic planning: floor that is likely to go on unseen
origins       Origins: where things were at first, and when that knowledge is lost
references    goals that name two things: which of them is moved, and when
joint         goals that cannot hold at once
"""
