"""The world: objects, doors, rooms and corners of the believed floor, as one frozen value and as facts.

Modules in reading order:

object_names  the names of objects, kept from one impression to the next
model         the world model, frozen: map, regions, objects, and what is derived from them
objects       nodes of the world model, made from regions of the map and from held objects
doors         the necks of the floor, and how surely each of them is a doorway
rooms         doors, and the parts of the floor between them
place_names   the names of doors and rooms, kept from one impression to the next
corners       the corners of the known floor
chances       the confidence of facts about places: rooms, contacts, doors, widths and corners
pathgraph     the pathgraph of the believed floor, as facts
evidence      what the world model rests on: explained fields, regions, necks of doors
facts         the world model as facts, and as the `belief` of an episode
stated_plan   the task plan as the facts of a step state it, as a value and in words

Public names: `WorldModel`, `Node` (model); `Rooms`, `Door`, `Opening`, `rooms_of` (rooms); `Corner`, `corners`
(corners); `Places`, `belief`, `model_facts` (facts);
`StatedPlan`, `stated_plan` (stated_plan).
"""
