"""`python -m robustnav_nodes` is the command `robustnav`, whatever PATH says."""

import sys

from robustnav_nodes.cli import main

sys.exit(main())
