#!/usr/bin/env bash
# The rules must be able to fail: every kind of forbidden include must be found.
set -euo pipefail
# shellcheck source=tests/repository_rules/wrong.sh
source tests/repository_rules/wrong.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/src/loop/core" "$tree/src/loop/control" "$tree/src/loop/physics" "$tree/src/loop/runtime" "$tree/src/new" \
  "$tree/src/driver_abi/wholehand" "$tree/src/devices/plugin"
echo '#include <vector>' >"$tree/src/loop/core/fine.hpp"
echo '#include "loop/core/fine.hpp"' >"$tree/src/loop/runtime/session.hpp"
echo '#include <stdint.h>' >"$tree/src/driver_abi/wholehand/device.h"
echo '#include "wholehand/device.h"' >"$tree/src/devices/plugin/driver.hpp"

expect() { # <message> <file> <content>
  local said
  printf '%s\n' "$3" >"$tree/src/$2"
  said=$(python3 scripts/check_includes.py "$tree" 2>&1) && wrong "not found: '$3' in $2"
  grep -qF "$1" <<<"$said" || wrong "expected '$1', got: $said"
  rm "$tree/src/$2"
}

python3 scripts/check_includes.py "$tree" >/dev/null
expect 'loop/control must not include loop/runtime/session.hpp' loop/control/a.cpp '#include "loop/runtime/session.hpp"'
expect 'loop/core must not include loop/runtime/session.hpp' loop/core/a.cpp '  #  include "loop/runtime/session.hpp"'
expect 'loop/core must not include wholehand/device.h' loop/core/a.cpp '#include <wholehand/device.h>'
expect 'driver_abi must not include loop/core/fine.hpp' driver_abi/wholehand/a.h '#include "loop/core/fine.hpp"'
expect 'only loop/physics/bullet, lab may include <btBulletDynamicsCommon.h>' loop/physics/a.hpp \
  '#include <btBulletDynamicsCommon.h>'
expect 'loop/control knows no clock, thread or I/O' loop/control/a.cpp '#include <thread>'
expect "loop/control has no 'virtual'" loop/control/a.hpp 'struct A { virtual void f(); };'
mkdir -p "$tree/src/rig" "$tree/apps" "$tree/lab" "$tree/include/wholehand"
echo 'int a;' | tee "$tree/apps/a.hpp" >"$tree/include/wholehand/a.hpp"
expect 'rig must not include apps/a.hpp' rig/a.cpp '#include "apps/a.hpp"'
echo 'int a;' >"$tree/lab/a.hpp"
expect 'rig must not include lab/a.hpp' rig/a.cpp '#include "lab/a.hpp"'
expect 'rig must not include wholehand/a.hpp' rig/a.cpp '#include "wholehand/a.hpp"'
expect 'is no file of ours' loop/core/a.cpp '#include "fine.hpp"'
expect 'its folder is not in scripts/include_rules.toml' new/a.cpp 'int a;'
# An installed header installs the headers it includes, too.
mkdir -p "$tree/include"
echo 'set(face loop/runtime/session.hpp)' >"$tree/include/CMakeLists.txt"
expect 'includes loop/core/fine.hpp, which is not installed' loop/core/a.cpp 'int a;'
echo 'set(face loop/runtime/session.hpp loop/core/fine.hpp)' >"$tree/include/CMakeLists.txt"
python3 scripts/check_includes.py "$tree" >/dev/null
# An include in a comment does not count.
echo '// #include "loop/runtime/session.hpp" and virtual' >"$tree/src/loop/control/a.cpp"
python3 scripts/check_includes.py "$tree" >/dev/null
# The table must not let a module include a module below it there, or an unknown one.
for listed in apps nothing; do
  cp scripts/check_includes.py scripts/include_rules.toml "$tree"
  sed -i "s/^rig = \\[/&\"$listed\", /" "$tree/include_rules.toml"
  said=$(python3 "$tree/check_includes.py" "$tree" 2>&1) && wrong "rig may include $listed"
  grep -qF "rig lists $listed" <<<"$said" || wrong "said of rig and $listed: $said"
done
