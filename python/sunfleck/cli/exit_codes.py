# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""exit_codes: what the commands exit with where it is neither 0 nor the 2 of an error."""

__all__ = ["INTERRUPTED"]

INTERRUPTED = 130  # 128 + SIGINT, as shells have it
