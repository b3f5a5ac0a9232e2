#!/usr/bin/env bash
# A rule that nothing can break is none: every kind of forbidden include must be found.
set -euo pipefail
# shellcheck source=tests/house/wrong.sh
source tests/house/wrong.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/src/core" "$tree/src/control" "$tree/src/physics" "$tree/src/runtime" "$tree/src/new" \
  "$tree/src/driver_abi/wholehand" "$tree/src/device/plugin"
echo '#include <vector>' >"$tree/src/core/fine.hpp"
echo '#include "core/fine.hpp"' >"$tree/src/runtime/session.hpp"
echo '#include <stdint.h>' >"$tree/src/driver_abi/wholehand/device.h"
echo '#include "wholehand/device.h"' >"$tree/src/device/plugin/driver.hpp"

expect() { # <message> <file> <content>
  local said
  printf '%s\n' "$3" >"$tree/src/$2"
  said=$(python3 scripts/check_includes.py "$tree" 2>&1) && wrong "not found: '$3' in $2"
  grep -qF "$1" <<<"$said" || wrong "expected '$1', got: $said"
  rm "$tree/src/$2"
}

python3 scripts/check_includes.py "$tree" >/dev/null
expect 'control must not include runtime/session.hpp' control/a.cpp '#include "runtime/session.hpp"'
expect 'core must not include runtime/session.hpp' core/a.cpp '  #  include "runtime/session.hpp"'
expect 'core must not include wholehand/device.h' core/a.cpp '#include <wholehand/device.h>'
expect 'driver_abi must not include core/fine.hpp' driver_abi/wholehand/a.h '#include "core/fine.hpp"'
expect 'only physics/bullet, lab may include <btBulletDynamicsCommon.h>' physics/a.hpp \
  '#include <btBulletDynamicsCommon.h>'
expect 'control knows no clock, thread or I/O' control/a.cpp '#include <thread>'
expect "control has no 'virtual'" control/a.hpp 'struct A { virtual void f(); };'
mkdir -p "$tree/src/assembly" "$tree/apps" "$tree/lab" "$tree/include/wholehand"
echo 'int a;' | tee "$tree/apps/a.hpp" >"$tree/include/wholehand/a.hpp"
expect 'assembly must not include apps/a.hpp' assembly/a.cpp '#include "apps/a.hpp"'
echo 'int a;' >"$tree/lab/a.hpp"
expect 'assembly must not include lab/a.hpp' assembly/a.cpp '#include "lab/a.hpp"'
expect 'assembly must not include wholehand/a.hpp' assembly/a.cpp '#include "wholehand/a.hpp"'
expect 'is no file of ours' core/a.cpp '#include "fine.hpp"'
expect 'its folder is not in scripts/include_rules.toml' new/a.cpp 'int a;'
# An installed header brings along what it includes.
mkdir -p "$tree/include"
echo 'set(face runtime/session.hpp)' >"$tree/include/CMakeLists.txt"
expect 'includes core/fine.hpp, which is not installed' core/a.cpp 'int a;'
echo 'set(face runtime/session.hpp core/fine.hpp)' >"$tree/include/CMakeLists.txt"
python3 scripts/check_includes.py "$tree" >/dev/null
# What stands in a comment includes nothing.
echo '// #include "runtime/session.hpp" and virtual' >"$tree/src/control/a.cpp"
python3 scripts/check_includes.py "$tree" >/dev/null
# Nor may the table let a module include what stands below it there, or what there is not.
for listed in apps nothing; do
  cp scripts/check_includes.py scripts/include_rules.toml "$tree"
  sed -i "s/^assembly = \\[/&\"$listed\", /" "$tree/include_rules.toml"
  said=$(python3 "$tree/check_includes.py" "$tree" 2>&1) && wrong "assembly may include $listed"
  grep -qF "assembly lists $listed" <<<"$said" || wrong "said of assembly and $listed: $said"
done
