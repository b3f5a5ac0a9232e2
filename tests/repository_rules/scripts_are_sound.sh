#!/usr/bin/env bash
# Shell scripts parse, run from any folder, and list packages that the scripts can read.
set -euo pipefail
# shellcheck source=tests/repository_rules/wrong.sh
source tests/repository_rules/wrong.sh
if [[ -e .git ]]; then
  mapfile -t scripts < <(git -c safe.directory="$PWD" ls-files '*.sh')
else # unpacked from an archive
  mapfile -t scripts < <(find scripts tests clients web/tests -name '*.sh')
fi
((${#scripts[@]} > 5)) || wrong "only ${#scripts[@]} scripts were found"
scripts+=(start check .ci/run)
for script in "${scripts[@]}"; do
  bash -n "$script"
done
for script in start check .ci/run scripts/build_times.py scripts/check_includes.py scripts/tidy.py; do
  [[ -x $script ]] || wrong "$script is not executable"
done
if command -v shellcheck >/dev/null; then
  shellcheck -x "${scripts[@]}"
fi
root=$PWD
# shellcheck source=scripts/lib.sh
source scripts/lib.sh
[[ $(packages_of run) == clang* && $(packages_of run) != *g++* ]]
[[ $(packages_of check) == *libgtest-dev* ]]
[[ $(packages_of web) == $'nodejs\nnpm' ]]
# A misspelt package name would count as missing on every machine.
if command -v apt-cache >/dev/null && apt-cache show clang >/dev/null 2>&1; then
  mapfile -t packages < <(packages_of run web check develop)
  known=" $(apt-cache show --no-all-versions "${packages[@]}" 2>/dev/null |
    sed -n 's/^Package: //p' | tr '\n' ' ') "
  for package in "${packages[@]}"; do
    [[ $known == *" $package "* ]] || wrong "scripts/packages.txt: Debian knows no package $package"
  done
fi
unknown=$(missing_packages dpkg no-such-package-anywhere)
[[ $unknown == no-such-package-anywhere ]]
[[ $(duration 125) == "2 min 05 s" ]]
