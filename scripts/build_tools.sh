#!/usr/bin/env bash
# build_tools.sh BUILD_FOLDER: builds wholehand-tools, for `wholehand NAME` in a checkout (apps/wholehand/shared/tools.hpp).
# Everything is said on standard error: the output of the command that follows is somebody's data.
set -euo pipefail
exec 1>&2
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"
folder=$(readlink -f "$1")
[[ $folder == "$root/build/${folder##*/}" ]] || fail "$folder is no build folder of $root/build; build there: ninja wholehand_tools"
one_at_a_time
say "Building wholehand-tools, which has this command ..."
build "${folder##*/}" wholehand_tools
