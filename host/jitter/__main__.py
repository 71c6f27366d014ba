# SPDX-License-Identifier: BSD-2-Clause
"""Entry point of ``python -m host.jitter``."""

import sys

from .cli import main

sys.exit(main())
