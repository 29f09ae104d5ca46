#!/bin/sh
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# Checks the layout of C and C++ against .clang-format; the generated files are as their scripts leave them.
set -eu
format=.venv/bin/clang-format # of the package's own list, so that all have one version of it
[ -n "$(git ls-files '*.c')" ] # a clone that git does not trust has no list
git ls-files '*.c' '*.h' '*.cpp' | grep -v -e '/tables/' -e '^csrc/mapping/mapping_f64.h' | xargs "$format" --dry-run -Werror
