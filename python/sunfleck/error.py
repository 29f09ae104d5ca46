# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""error: the exception for what no built-in one says."""

__all__ = ["Error"]


class Error(RuntimeError):
    """What only the libraries underneath can tell: Embree reported an error of its own."""
