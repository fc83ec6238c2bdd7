"""An independent plant of the water-hydraulic joint, to hide effects in; it shares no code with `hjcamp`.

Importable as `truth` (from tests/) or `tests.truth` (from the project's root); inside, always as `truth`.
"""

import sys
from pathlib import Path

# One name for the modules, so that compiled code and its cache are the same whichever way the package is imported.
_parent = str(Path(__file__).resolve().parent.parent)
if _parent not in sys.path:
    sys.path.append(_parent)
