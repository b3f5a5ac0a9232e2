#!/usr/bin/env bash
# scripts/passed.py on a small build of its own: a test is skipped only after it passed with the same object, data and
# environment, and not when one of them changed while it ran.
set -euo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
# shellcheck source=tests/repository_rules/wrong.sh
source tests/repository_rules/wrong.sh
mkdir -p "$tree/scripts" "$tree/build" "$tree/config" "$tree/web"
cp scripts/passed.py "$tree/scripts/"
printf 'rule make\n  command = true\nbuild test_a: make a.o program_version.cpp.o\n' >"$tree/build/build.ninja"
echo build/ >"$tree/.gitignore"
echo object >"$tree/build/a.o"
echo version >"$tree/build/program_version.cpp.o"
echo data >"$tree/config/a.toml"
echo page >"$tree/web/page.ts"
git -C "$tree" init -q

asked() { (cd "$tree" && WHOLEHAND_SEED=$RANDOM python3 scripts/passed.py build "$@"); }
due() { [[ $(asked due a/1=test_a) == a/1=test_a ]] || wrong "skipped although $1" ""; }
skipped() { [[ -z $(asked due a/1=test_a) ]] || wrong "not skipped although $1" ""; }
passes() { asked keep a/1=test_a; }

asked keep a/1=test_a
due "it never ran"
passes
skipped "nothing has changed but the seed"
echo newer >"$tree/build/program_version.cpp.o"
skipped "only the version of the sources has changed"
echo newer >"$tree/web/page.ts"
skipped "only a page has changed"
for changed in build/a.o config/a.toml; do
  echo "$changed newer" >"$tree/$changed"
  due "$changed has changed"
  echo "$changed newest" >"$tree/$changed" # while the test runs
  passes
  due "$changed changed while it ran"
  passes
  skipped "$changed is the one that it passed with"
done
export WHOLEHAND_FULL=1
due "a variable that tests read has changed"
