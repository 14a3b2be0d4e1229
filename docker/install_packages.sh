#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Installs sections of docker/packages.txt: install_packages.sh build runtime test. If all packages are installed, it does
# nothing and needs no root. "run", "test" and the Dockerfile call this, so there is only one list.
set -euo pipefail
list="$(dirname "${BASH_SOURCE[0]}")/packages.txt"

# Names of installed packages, and names that they provide: a nodejs that is not Debian's includes npm.
installed=$(dpkg-query -W -f '${db:Status-Status},${Package},${Provides}\n' | sed -n 's/^installed,//p' | tr ',' '\n' |
  sed 's/^ *//; s/ .*//' | sort -u)

# The lines without an installed package.
missing=()
for section in "$@"; do
  grep -qx "\[$section\]" "$list" || { echo "$list has no section [$section]" >&2; exit 64; }
  while read -r line; do
    grep -qxF -f <(tr '|' '\n' <<<"${line#optional }" | tr -d ' ') <<<"$installed" || missing+=("$line")
  done < <(awk -v want="[$section]" '/^\[/ { inside = ($0 == want); next } inside && NF && !/^#/' "$list")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || { printf 'To install packages, you need root or sudo. Missing packages:\n'; printf '  %s\n' "${missing[@]}"; exit 1; } >&2
  as_root=(sudo)
fi

# The first name in each line that this release has.
choose() {
  local line name
  chosen=() left_out=()
  for line in "${missing[@]}"; do
    for name in $(tr '|' ' ' <<<"${line#optional }"); do
      if apt-cache show --no-all-versions "$name" >/dev/null 2>&1; then
        chosen+=("$name")
        continue 2
      fi
    done
    [[ $line == optional\ * ]] || left_out+=("$line")
  done
}

choose
if ((${#chosen[@]} + ${#left_out[@]})); then  # else only what this release does not have anyway
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  choose
  ((${#left_out[@]} == 0)) || { echo "This release has no packages with these names: ${left_out[*]} (listed in $list)" >&2; exit 1; }
  echo "Installing ${#chosen[@]} packages with apt: ${chosen[*]}"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${chosen[@]}" >/dev/null
fi
