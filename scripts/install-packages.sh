#!/bin/sh
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

# install-packages.sh PACKAGE…: installs those Debian packages that are missing, as root or by a
# sudo that asks for no password; otherwise says what to run. Quick where nothing is missing.
set -eu

if ! command -v dpkg-query >/dev/null; then
    echo "note: not a Debian system; this needs what Debian calls: $*" >&2
    exit 0
fi

missing=
for package in "$@"; do
    status=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)
    case $status in
        ii*) ;;
        *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -eq 0 ]; then
    as_root=env
elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    as_root="sudo -n env"
else
    echo "error: packages are missing, and this is neither root nor a user with sudo. As root, run:" >&2
    echo "    apt-get update && apt-get install -y --no-install-recommends$missing" >&2
    exit 1
fi

echo "installing$missing"
# A source that fails to update is no reason to stop if the packages can be had all the same.
$as_root apt-get -q update || echo "note: apt-get update failed; trying with the lists at hand" >&2
# shellcheck disable=SC2086
$as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=120 \
    install --no-install-recommends $missing </dev/null
