#!/bin/sh
# run_shards.sh <count> <test program>: runs the program's tests in `count` parallel processes. For tests that wait most
# of their time. Prints the output of each, failed ones last; fails if one fails.
count=$1 program=$2 folder=$(mktemp -d) status=0 failed=
trap 'rm -rf "$folder"' EXIT
i=0
while [ "$i" -lt "$count" ]; do
  GTEST_TOTAL_SHARDS=$count GTEST_SHARD_INDEX=$i "$program" >"$folder/$i" 2>&1 &
  eval "process_$i=$!"
  i=$((i + 1))
done
i=0
while [ "$i" -lt "$count" ]; do
  process=$(eval "echo \"\$process_$i\"")
  if wait "$process"; then cat "$folder/$i"; else status=1 failed="$failed $i"; fi
  i=$((i + 1))
done
for i in $failed; do cat "$folder/$i"; done
exit $status
