"""Lets the tests here import the modules beside them (a package named tests may be installed by others)."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
