#!/usr/bin/env bash
# embed.sh BUILD CONSUMER COMPILER: installs the package, then configures, builds and runs a project
# outside the tree that knows nothing but the place of the installation.
set -euo pipefail
build=$1 consumer=$2 compiler=$3
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

fail() {
  echo "$*"
  exit 1
}
cmake --install "$build" --component embedding --prefix "$tree/prefix" >"$tree/log" ||
  fail "$(cat "$tree/log")"
# Moved: nothing in the package may remember where it was installed, or built.
mv "$tree/prefix" "$tree/moved"
grep -rlF -e "$build" -e "$tree/prefix" "$tree/moved" --include='*.cmake' --include='*.hpp' &&
  fail "these files name a folder of the build"

cp -r "$consumer" "$tree/consumer"
cmake -G Ninja -S "$tree/consumer" -B "$tree/out" -DCMAKE_PREFIX_PATH="$tree/moved" \
  -DCMAKE_CXX_COMPILER="$compiler" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
# Any warning fails: the headers must be clean in a project stricter than ours.
cmake --build "$tree/out" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
"$tree/out/consumer"

# Every installed header stands in the installed folders, and of the vendors only Eigen shows.
(cd "$tree/moved/include" && find . -name '*.hpp' -printf '#include "%P"\n') >"$tree/all.cpp"
(($(wc -l <"$tree/all.cpp") > 20)) || fail "the headers are not installed"
"$compiler" -std=c++20 -I"$tree/moved/include" -I"$tree/moved/include/wholehand" \
  -isystem /usr/include/eigen3 -M "$tree/all.cpp" >"$tree/seen"
if grep -oE '[^ ]*/(bullet|toml\+\+|hdf5|assimp|tinyxml2|fmt|nlohmann|CLI|libpng16)(/|\.h)[^ ]*' \
  "$tree/seen"; then
  fail "vendors show in the public headers"
fi
# The malloc that counts must never reach a program that embeds us.
if nm -C --defined-only "$tree/out/consumer" | grep -E ' [TW] (malloc|free)$'; then
  fail "the consumer's malloc is replaced"
fi
