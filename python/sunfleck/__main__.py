# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""`python -m sunfleck` is the command `sunfleck`."""

import sys

from sunfleck.cli import main

sys.exit(main())
