#!/usr/bin/env bash
# package.sh [--try]: makes the Debian packages in build/packages, and lets lintian judge them.
# --try installs them in a bare Debian in a folder (debootstrap; needs root) and runs the program there.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"
cd "$root"

case ${1:-} in
  '' | --try) ;;
  -h | --help) sed -n 's/^# //p' "$0" | sed -n '1,2p' && exit 0 ;;
  *) fail "unknown argument $1; usage: scripts/package.sh [--try]" ;;
esac
one_at_a_time
install_packages run package
pages_are_current || { install_node && build_web; }
if [[ ! -f build/release/build.ninja ]]; then
  configure release -DWHOLEHAND_BUILD_TESTS=OFF -DWHOLEHAND_LAB=OFF -DWHOLEHAND_QUICK=OFF
else
  configure release -DWHOLEHAND_LAB=OFF -DWHOLEHAND_QUICK=OFF # finds what was installed since
fi
build release wholehand wholehand_tools wholehand_clinic_program wholehand_python
make_packages
for package in build/packages/*.deb; do
  say "$package $(($(stat -c %s "$package") / 1000)) kB"
done
if [[ ${1:-} == --try ]]; then bash packaging/try_in_bare_debian.sh build/packages; fi
