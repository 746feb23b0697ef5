"""Carrying objects: plans that geometry verifies, and their execution.

manipulation_oracle  manipulation plans: geometry is asked in the order that an encoding chooses
preconditions        what must be seen or felt before a plan is begun, and what its turns cost
remaining_plan       what is left of a manipulation plan, checked against the world and cut where needed
plan_executor        the plan under way: followed, checked after every impression, made anew when it fails
infeasibility        infeasibility certificates: why nothing can be carried, and how far that is proved
open_facts           facts that are open and would overturn such a proof

Public names: ManipulationOracle, ManipulationPlan, Request, RemainingPlan, PlanExecutor, Infeasibility, Refutation,
certify, qualify.
"""
