"""Scenarios as tests: what `utak test` and the plugin of pytest (utak.pytest_plugin) run and say.

Modules in reading order:

record   one scenario, tried: its outcome as JSON values, whatever is wrong with it
suite    all scenarios of a command line: finding, choosing and trying them, in one process or in several
wording  records as text: lines, summaries and reports of failures
junit    records as JUnit XML
grades   records as a table, comma-separated values

Public names: `Wish`, `try_scenario`, `failure_report`, `as_junit`.
"""
