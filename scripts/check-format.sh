#!/bin/sh
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# Checks the layout of C and C++ against .clang-format, where clang-format is installed.
set -eu
if ! command -v clang-format >/dev/null; then
    echo "note: no clang-format here; layout not checked" >&2
    exit 0
fi
git ls-files '*.c' '*.h' '*.cpp' | grep -v '^csrc/tables/' | xargs clang-format --dry-run -Werror
