#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Makes the manual pages from the programs' --help, and the changelog, both compressed.
#   make_pages.sh PROGRAMS PACKAGING CHANGELOG OUT CONTACT REVISION
# at_commit_time.sh calls it, so that the pages have the commit's time.
set -euo pipefail
programs=$1 packaging=$2 changelog=$3 out=$4 contact=$5 revision=$6
rm -rf "$out"
mkdir -p "$out/man/man1" "$out/man/man5"
version=$("$programs/sonard" --version | sed -E 's/^sonard ([^,]*).*/\1/')

# page NAME SUMMARY COMMAND...
page() {
  local name=$1 summary=$2
  shift 2
  help2man --no-info --no-discard-stderr --name="$summary" --source="sonard $version" --version-string="$version" \
    --manual="sonard" "$*" | sed -E "/^\.\\\\\" DO NOT MODIFY/d; s/^[a-z ]+ (\\\\- )/$name \1/" >"$out/man/man1/$name.1"
}

page sonard "emulator of imaging sonars on the network, rendered from a 3D world" "$programs/sonard"
page sonarview "client of imaging sonars" "$programs/sonarview"
page posecast "plays a trajectory as a pose stream for sonard" "$programs/posecast"
"$programs/sonard" --help | sed -n '/^Subcommands:/,/^$/ s/^  \([a-z]*\)  */\1 /p' | while read -r command summary; do
  page "sonard-$command" "${summary,}" "$programs/sonard" "$command"
done
cp "$packaging/roscast.1" "$out/man/man1/"  # its --help needs ROS
cp "$packaging/sonard.yaml.5" "$out/man/man5/"
find "$out/man" -type f -exec gzip -9n {} +
gzip -9nc "$changelog" >"$out/changelog.gz"
gzip -9n >"$out/changelog.Debian.gz" <<END
sonard ($version-$revision) unstable; urgency=medium

  * See changelog.gz for the changes.

 -- $contact  $(date -u -R -d "@${SOURCE_DATE_EPOCH:-0}")
END
touch "$out/made"
