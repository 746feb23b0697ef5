"""Odd random worlds: kinds of floors and things that ordinary random worlds do not have.

Read `houses` (floors), `lying` (places of things), `tasks` (goals and what is true at the end), the kinds `offgrid`,
`slanted`, `circular`, `plugged`, `touching`, `openings`, `fixtures` and `constraints`, and `kinds` (all by name).
"""
