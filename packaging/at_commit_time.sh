#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs a command with the commit's time as its time, so that the same commit makes the same package.
#   at_commit_time.sh COMMAND...
set -euo pipefail
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$(dirname "${BASH_SOURCE[0]}")" log -1 --format=%ct 2>/dev/null || echo 0)}
exec "$@"
