# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""`python -m sunfleck.cli` is the command `sunfleck` too."""

import sys

from sunfleck.cli import main

sys.exit(main())
