"""python -m tentacle: the command line."""

import sys

from tentacle.cli import main

sys.exit(main())
