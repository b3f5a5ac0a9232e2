#!/usr/bin/env bash
# Builds what the sanitizer steps of ./check run, while its other tests wait for something: at idle
# priority, so that no test feels it. ./check ends it by SIGTERM before it builds there itself.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"

# Linux may share the processors among sessions first: this one has the smallest share.
{ echo 19 >/proc/self/autogroup; } 2>/dev/null || true
chrt --idle --pid 0 $$
for preset in "${sanitizers[@]}"; do build_for_tests "$preset"; done
