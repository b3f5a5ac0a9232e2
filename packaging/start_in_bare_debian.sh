#!/usr/bin/env bash
# start_in_bare_debian.sh: ./start of the last commit in a bare Debian 12, as a user with sudo and as root.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
# shellcheck source=packaging/bare_debian.sh
source "$(dirname "$0")/bare_debian.sh"

mkdir -p "$bare/srv/wholehand"
git -C "$root" bundle create -q "$bare/tmp/sources" HEAD
inside 'export DEBIAN_FRONTEND=noninteractive
  apt-get -q update >/dev/null
  apt-get -q install -y --no-install-recommends git sudo ca-certificates >/tmp/log 2>&1 || { tail /tmp/log; exit 1; }
  useradd person && echo "person ALL=(ALL) NOPASSWD: ALL" >/etc/sudoers.d/person
  cd /srv/wholehand && git clone -q /tmp/sources . && chown -R person: . '
play='./start --no-web --simulated-clock --duration 1'
echo "As a user with sudo:"
inside "su person -c 'cd /srv/wholehand && $play'"
echo "As root, where a package is missing:"
inside "apt-get -q purge -y libsodium-dev >/tmp/log 2>&1
  cd /srv/wholehand && git config --global --add safe.directory /srv/wholehand && $play && dpkg -s libsodium-dev >/dev/null"
