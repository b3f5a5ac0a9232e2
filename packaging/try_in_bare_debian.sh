#!/usr/bin/env bash
# try_in_bare_debian.sh FOLDER_OF_PACKAGES: installs the packages in a bare Debian 12 (debootstrap into a folder; needs
# root), runs the program there, builds against the library, reads a recording from Python, and removes everything
# again.
set -euo pipefail
packages=$(readlink -f "$1")

# shellcheck source=packaging/bare_debian.sh
source "$(dirname "$0")/bare_debian.sh"
mkdir "$bare/tmp/packages"
cp "$packages"/*.deb "$bare/tmp/packages/"

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
