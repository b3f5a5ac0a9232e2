#!/usr/bin/env bash
# fuzz.sh PROGRAM TARGET FOLDER: runs libFuzzer on one fuzz target for WHOLEHAND_FUZZ_S seconds (2), or with
# WHOLEHAND_FUZZ_RUNS inputs, starting from the kept corpus.
# FOLDER keeps the inputs it found; a failing input is named there and can be run again with
#    PROGRAM --target=TARGET FILE
set -euo pipefail
program=$1 target=$2 folder=$3/$2
if [[ -n ${WHOLEHAND_FUZZ_RUNS:-} ]]; then
  until="-runs=$WHOLEHAND_FUZZ_RUNS"
else
  until="-max_total_time=${WHOLEHAND_FUZZ_S:-2}"
fi
corpus=$(cd "$(dirname "$0")" && pwd)/corpus/$target.tar.xz
mkdir -p "$folder/found" "$folder/good" "$folder/kept"
if [[ -f $corpus ]]; then tar -xJf "$corpus" -C "$folder/kept"; fi
# Files that are written for every input stay in memory: on a disk they take ten times as long.
if [[ -w /dev/shm ]]; then export TMPDIR=/dev/shm; fi
# The limits are a second and 256 MB per input; a slow machine gets sixty seconds.
export ASAN_OPTIONS=${ASAN_OPTIONS:-}:quarantine_size_mb=16:detect_leaks=0
exec "$program" "--target=$target" "--good=$folder/good" -seed="$((${WHOLEHAND_SEED:-1} % 2147483647 + 1))" \
  "$until" -timeout=60 -report_slow_units=1 -malloc_limit_mb=256 -rss_limit_mb=1024 \
  -print_final_stats=1 -verbosity=0 -artifact_prefix="$folder/" "$folder/found" "$folder/good" "$folder/kept"
