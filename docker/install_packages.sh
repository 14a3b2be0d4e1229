#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Installs sections of docker/packages.txt: install_packages.sh build runtime test. Does nothing, and needs no
# rights, when all is there. "run", "test" and the Dockerfile call this, so the list is the only one.
set -euo pipefail
list="$(dirname "${BASH_SOURCE[0]}")/packages.txt"

# What is installed under its own name, or provided by a package of another: where node is not Debian's it brings npm.
provided=$(dpkg-query -W -f '${db:Status-Status},${Provides}\n' | sed -n 's/^installed,//p' | tr ',' '\n' | sed 's/^ *//; s/ .*//')
missing=()
for section in "$@"; do
  grep -qx "\[$section\]" "$list" || { echo "$list has no section [$section]" >&2; exit 64; }
  while read -r package; do
    dpkg-query -W -f '${Status}\n' "$package" 2>/dev/null | grep -q '^install ok installed$' ||
      grep -qx "$package" <<<"$provided" || missing+=("$package")
  done < <(awk -v want="[$section]" '/^\[/ { inside = ($0 == want); next } inside && NF && !/^#/' "$list")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || { echo "Not root and no sudo. Please install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing ${#missing[@]} packages with apt: ${missing[*]}"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
