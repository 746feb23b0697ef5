"""Random worlds with tasks about several things, in which order and places matter.

Modules, in reading order:

tasks      what is wanted in which stage, and whether the truth meets it
scene      floors, things that can be told apart, their places, and the robot's
corners    two things into two corners
rooms      two things that change rooms; three things into the next room
narrow     closets, dead ends, and necks that one thing shall fill or other things must be cleared from
sequences  sequences of four steps
kinds      all kinds by name
"""
