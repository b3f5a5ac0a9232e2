#!/usr/bin/env bash
# No file of the repository may refer to the machine it was written on.
set -euo pipefail
# Written in pieces, so that this file does not find itself.
pattern="/wo""rk/|shar""ed/(design|reference|paper|data|mockups)|/ho""me/[a-z]|/tmp/who""lehand"
if grep -rnIE "$pattern" --exclude-dir=.git --exclude-dir=build --exclude-dir=out \
  --exclude-dir=__pycache__ --exclude-dir=.cache --exclude-dir=node_modules --exclude-dir=dist . ; then
  echo "these lines name a place that only one machine has"
  exit 1
fi
