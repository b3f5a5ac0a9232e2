#!/usr/bin/env bash
# ./start on machines that cannot install: played by stand-ins for apt-get, sudo and dpkg-query.
set -euo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/repo/scripts" "$tree/bin"
cp start "$tree/repo/"
cp scripts/lib.sh scripts/packages.txt "$tree/repo/scripts/"

stand_in() { # <program>, its script on standard input
  { echo '#!/bin/bash' && cat; } >"$tree/bin/$1"
  chmod +x "$tree/bin/$1"
}
# Everything of [run] is installed but two packages; one of them was removed once.
stand_in dpkg-query <<'EOF'
for p in g++ cmake ninja-build pkg-config git libeigen3-dev libbullet-dev libassimp-dev \
  libtinyxml2-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libhdf5-dev; do
  echo "installed $p"
done
echo "config-files libpng-dev"
EOF
stand_in apt-get <<'EOF'
echo "E: Failed to fetch: Temporary failure resolving" >&2
exit 100
EOF
# A PATH of the system without its sudo.
for tool in bash env sed tr grep dirname readlink mkdir cat tail nproc awk find; do
  ln -s "$(command -v "$tool")" "$tree/bin/$tool" 2>/dev/null || true
done

expect() { # <text> <what was said>
  grep -qF -- "$1" <<<"$2" || {
    echo "expected '$1', got:"
    echo "$2"
    exit 1
  }
}
cd /
if said=$(PATH="$tree/bin" "$tree/bin/bash" "$tree/repo/start" </dev/null 2>&1); then
  echo "./start went on without packages"
  exit 1
fi
expect 'Missing packages: libfmt-dev libpng-dev' "$said"
expect 'apt-get install --no-install-recommends libfmt-dev libpng-dev' "$said"
if ((EUID == 0)); then
  expect 'is there a network?' "$said"
  expect 'Temporary failure resolving' "$said"
else
  expect 'there is no sudo here' "$said"
fi
