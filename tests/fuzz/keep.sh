#!/usr/bin/env bash
# keep.sh PROGRAM DOOR FOLDER: of what fuzz.sh found, the least that takes every way becomes the kept corpus.
set -euo pipefail
program=$1 door=$2 folder=$3/$2
corpus=$(cd "$(dirname "$0")" && pwd)/corpus
rm -rf "$folder/least" && mkdir -p "$folder/least" "$folder/kept" "$corpus"
ASAN_OPTIONS=detect_leaks=0 "$program" "--door=$door" -merge=1 "$folder/least" "$folder/kept" "$folder/found" \
  >"$folder/keep.log" 2>&1
tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -cJf "$corpus/$door.tar.xz" -C "$folder/least" .
