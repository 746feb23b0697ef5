"""WorldChanges that would have made failing scenarios work, found, and confirmed from their files.

__main__  the command line: `python -m benchmarks.fixes FOLDER...`
"""
