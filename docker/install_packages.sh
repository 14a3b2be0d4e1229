#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Installs sections of docker/packages.txt: install_packages.sh build runtime test. If all packages are installed, it does
# nothing and needs no root. "run", "test" and the Dockerfile call this, so there is only one list.
set -euo pipefail
list="$(dirname "${BASH_SOURCE[0]}")/packages.txt"

lines=()
for section in "$@"; do
  grep -qx "\[$section\]" "$list" || { echo "$list has no section [$section]" >&2; exit 64; }
  mapfile -t -O "${#lines[@]}" lines < <(awk -v want="[$section]" '/^\[/ { inside = ($0 == want); next } inside && NF && !/^#/' "$list")
done

# Names of installed packages, and names that they provide: a nodejs that is not Debian's includes npm.
installed=$(dpkg-query -W -f '${db:Status-Status},${Package},${Provides}\n' | sed -n 's/^installed,//p' | tr ',' '\n' |
  sed 's/^ *//; s/ .*//' | sort -u)
is_installed() { grep -qxF -- "$1" <<<"$installed"; }
is_known() { apt-cache show --no-all-versions "$1" >/dev/null 2>&1; }

# libraries_of DEV: the shared libraries that package DEV depends on, without those of the C library.
libraries_of() {
  apt-cache depends --important "$1" | sed -n 's/^ *|\?Depends: \(lib[^<>]*\)$/\1/p' | grep -vE -e '-dev$|^libc6|-lite|^libtiffxx' | sort -u
}

# Sorts the lines: `missing` are packages that can be installed, `left_out` lines that this release does not have.
choose() {
  local line name names package
  missing=() left_out=()
  for line in "${lines[@]}"; do
    names=${line#optional }
    for name in $(tr '|' ' ' <<<"${names#libraries of }"); do
      [[ $names == "libraries of "* ]] || ! is_installed "$name" || continue 2
      is_known "$name" || continue
      [[ $names != "libraries of "* ]] || name=$(libraries_of "$name")
      for package in $name; do
        is_installed "$package" || missing+=("$package")
      done
      continue 2
    done
    [[ $line == optional\ * ]] || left_out+=("$line")
  done
}

choose
((${#missing[@]} + ${#left_out[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null ||
    { printf 'To install packages, you need root or sudo. Missing packages:\n'; printf '  %s\n' "${missing[@]}" "${left_out[@]}"; exit 1; } >&2
  as_root=(sudo)
fi
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
choose
((${#left_out[@]} == 0)) || { echo "This release has no packages with these names: ${left_out[*]} (listed in $list)" >&2; exit 1; }
((${#missing[@]})) || exit 0
echo "Installing ${#missing[@]} packages with apt: ${missing[*]}"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
