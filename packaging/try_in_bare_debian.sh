#!/usr/bin/env bash
# try_in_bare_debian.sh FOLDER_OF_PACKAGES: installs the packages in a bare Debian 12 (debootstrap into a folder; needs
# root), runs the program there, builds against the library, reads a recording from Python, and removes everything
# again.
set -euo pipefail
packages=$(readlink -f "$1")

fail() {
  echo "$*" >&2
  exit 1
}
((EUID == 0)) || fail "a bare Debian is made by root: sudo $0 $1"
command -v debootstrap >/dev/null || fail "debootstrap is missing: apt-get install debootstrap"
bare=$(mktemp -d)
trap 'umount "$bare/proc" 2>/dev/null || true; rm -rf --one-file-system "$bare"' EXIT

mirror=$(sed -nE 's/^(deb|URIs:) *(\[[^]]*\] *)?(https?:[^ ]*).*/\3/p' /etc/apt/sources.list \
  /etc/apt/sources.list.d/* 2>/dev/null | sed -n 1p || true)
echo "A bare Debian 12 from ${mirror:-deb.debian.org} ..."
debootstrap --variant=minbase bookworm "$bare" "${mirror:-http://deb.debian.org/debian}" >"$bare.log" 2>&1 ||
  fail "$(tail -n 5 "$bare.log")"
# Uses the package sources, keys and proxies of this machine.
rm -rf "$bare/etc/apt"
cp -r /etc/apt "$bare/etc/apt"
if [[ -d /usr/share/keyrings ]]; then cp -rn /usr/share/keyrings "$bare/usr/share/"; fi
if [[ -d /etc/ssl/certs ]]; then mkdir -p "$bare/etc/ssl" && cp -r /etc/ssl/certs "$bare/etc/ssl/"; fi
cp /etc/resolv.conf "$bare/etc/resolv.conf"
mount -t proc proc "$bare/proc"
mkdir "$bare/tmp/packages"
cp "$packages"/*.deb "$bare/tmp/packages/"

inside() { chroot "$bare" env -i HOME=/root LC_ALL=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin bash -euc "$1"; }
inside 'export DEBIAN_FRONTEND=noninteractive
  apt-get -q update >/dev/null
  apt-get -q install -y --no-install-recommends /tmp/packages/wholehand_*.deb >/tmp/log 2>&1 || { tail /tmp/log; exit 1; }'
echo "Installed: $(inside 'dpkg -s wholehand | sed -n "s/^Version: //p"')"
inside 'mkdir /tmp/try; cd /tmp/try
  wholehand --version
  wholehand validate /usr/share/wholehand/config/devices/lambda-pride.toml
  wholehand run --motion /usr/share/wholehand/data/human-motion/reach-grasp-00.csv --simulated-clock --record run.h5 --report page
  test -s page/index.html
  getent group realtime >/dev/null'
inside 'export DEBIAN_FRONTEND=noninteractive
  apt-get -q install -y --no-install-recommends /tmp/packages/python3-wholehand_*.deb /tmp/packages/libwholehand-dev_*.deb g++ cmake ninja-build \
    >/tmp/log 2>&1 || { tail /tmp/log; exit 1; }
  cd /tmp/try
  python3 -c "import wholehand, wholehand.client; print(len(wholehand.open(\"run.h5\")[\"ticks/q_s\"]), \"ticks read by Python\")"
  python3 -c "from wholehand.rig import Rig; print(Rig().step(n=100), \"ticks run by Python\")"'
mkdir "$bare/tmp/consumer"
cp "$(dirname "$0")"/../tests/examples/consumer/* "$bare/tmp/consumer/"
inside 'cd /tmp/consumer && cmake -G Ninja -B out . >/tmp/log && ninja -C out consumer >/tmp/log && ./out/consumer'
inside 'apt-get -q purge -y wholehand >/tmp/log 2>&1
  test ! -e /usr/share/wholehand && test ! -e /etc/security/limits.d/wholehand.conf'
echo "Removed again: nothing is left."
