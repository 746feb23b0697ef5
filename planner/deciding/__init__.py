"""Deciding: how activities are done, each from what is believed to the next command or a verdict.

transport     a goal for an object: find it, look at it, carry it, or give up
errands       the next step of the task plan, carried out
bringing      an object is brought to an end that no goal of its own asks for
clearing      navigation among movable obstacles: what blocks the robot is moved aside
obstacles     the objects that block the way, as they lie or as they may go on in a wall
feeling       before the robot gives up, it feels walls that may be things or have an opening
trials        what seems one thing is felt all round and moved once, for it may be several; what did not move, each way;
              and passages are measured
pursuit       subgoals of the robot itself: the best one, the route there, the next move
keeping       whether constraints on the way were kept, by the tracks of the robot and of the things
search        subgoals while something is missing
verification  goal verification and active perception: looks that make sure
stage_turn    what one decision is worked out with: the stage, what is believed, and the tools

Public names: Transporter, ErrandRunner, ObstacleClearer, Trials, Pursuer, Verifier, StageTurn, subgoals_towards.
"""
