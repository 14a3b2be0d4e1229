#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Checks that the same commit makes the same package: two clones in different folders, built without a cache, because the
# second build would reuse files of the first.
set -euo pipefail
repository=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
folder=$(mktemp -d "${TMPDIR:-/tmp}/sonard-same-bytes-XXXXXX")
trap 'rm -rf "$folder"' EXIT
export CCACHE_DISABLE=1
packages=()
places=(here/it/is elsewhere)
for place in "${places[@]}"; do  # both before the builds, during which somebody may commit
  git clone --quiet "$repository" "$folder/$place"
done
for place in "${places[@]}"; do
  cd "$folder/$place"
  cmake --preset release -DSONARD_TESTS=OFF >/dev/null
  cmake --build --preset release --target debian_package
  packages+=("$PWD"/build/release/sonard_*.deb)
done
if cmp "${packages[@]}"; then
  echo "the same bytes twice: $(sha256sum <"${packages[0]}" | cut -d' ' -f1)"
else
  sums() { dpkg-deb --ctrl-tarfile "$1" | tar -xO ./md5sums; }
  diff <(sums "${packages[0]}") <(sums "${packages[1]}") || true  # the files that differ
  exit 1
fi
