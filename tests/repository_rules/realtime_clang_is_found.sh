#!/usr/bin/env bash
# ./check looks for a clang with RealtimeSanitizer: not an old one, nor one without the runtime. It may be called
# clang++-21.
set -euo pipefail
root=$PWD
# shellcheck source=scripts/lib.sh
source scripts/lib.sh
bin=$(mktemp -d)
trap 'rm -rf "$bin"' EXIT
# clang <name> <version> <exit code of a link>
clang() {
  # shellcheck disable=SC2016
  printf '#!/bin/sh\n[ "$1" = -dumpversion ] && echo %s && exit 0\nexit %s\n' "$2" "$3" >"$bin/$1"
  chmod +x "$bin/$1"
}
found() { PATH=$bin realtime_clang || echo none; }
expect() {
  [[ $(found) == "$1" ]] || {
    echo "expected $1, found $(found)"
    exit 1
  }
}
expect none
clang clang++ 14.0.6 0
expect none
clang clang++-20 20.1.8 1 # its runtime is not installed
expect none
clang clang++-21 21.1.0 0
expect clang++-21
clang clang++ 22.0.0 0
expect clang++
