#!/usr/bin/env bash
# keep.sh PROGRAM TARGET FOLDER: the smallest subset of fuzz.sh's inputs that covers every branch becomes the kept
# corpus.
set -euo pipefail
program=$1 target=$2 folder=$3/$2
corpus=$(cd "$(dirname "$0")" && pwd)/corpus
rm -rf "$folder/least" && mkdir -p "$folder/least" "$folder/kept" "$corpus"
ASAN_OPTIONS=detect_leaks=0 "$program" "--target=$target" -merge=1 "$folder/least" "$folder/kept" "$folder/found" \
  >"$folder/keep.log" 2>&1
tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -cJf "$corpus/$target.tar.xz" -C "$folder/least" .
