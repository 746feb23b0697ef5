"""Makes the modules of this folder importable by its tests (others may have installed a package named tests)."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
