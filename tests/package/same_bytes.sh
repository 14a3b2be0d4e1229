#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Whether the same commit makes the same package: a clone in a folder of its own, built without a cache.
#   same_bytes.sh PACKAGE.deb      of a build of what is committed here
set -euo pipefail
package=$(realpath "$1")
repository=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
[[ -z $(git -C "$repository" status --porcelain) ]] || { echo "there are changes that no commit has: their bytes cannot be made again" >&2; exit 1; }
folder=$(mktemp -d "${TMPDIR:-/tmp}/sonard-same-bytes-XXXXXX")
trap 'rm -rf "$folder"' EXIT
git clone --quiet "$repository" "$folder/elsewhere"
cd "$folder/elsewhere"
export CCACHE_DISABLE=1
cmake --preset release -DSONARD_TESTS=OFF >/dev/null
cmake --build --preset release --target debian_package
again=$(echo build/release/sonard_*.deb)
if cmp "$package" "$again"; then
  echo "the same bytes: $(sha256sum <"$again")"
else
  # Which files differ, by their checksums.
  diff <(dpkg-deb --ctrl-tarfile "$package" | tar -xO ./md5sums) <(dpkg-deb --ctrl-tarfile "$again" | tar -xO ./md5sums) || true
  exit 1
fi
