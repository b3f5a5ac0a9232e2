#!/usr/bin/env bash
# embed.sh BUILD CONSUMER COMPILER: installs the package, then configures, builds and runs projects
# outside the tree that know nothing but the place of the installation: a consumer, and the installed examples.
set -euo pipefail
build=$1 consumer=$2 compiler=$3
tree=$(mktemp -d)
trap 'kill -KILL ${serving:-} 2>/dev/null || true; rm -rf "$tree"' EXIT

fail() {
  echo "$*"
  exit 1
}
cmake --install "$build" --prefix "$tree/prefix" >"$tree/log" ||
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

examples=$tree/moved/share/doc/wholehand/examples
cmake -G Ninja -S "$examples" -B "$tree/examples" -DCMAKE_PREFIX_PATH="$tree/moved" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
cmake --build "$tree/examples" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
"$tree/examples/01_first_touch" >"$tree/touched" || fail "the first example does not run"
(($(wc -l <"$tree/touched") == 22)) || fail "$(cat "$tree/touched")"

# Driver, station and server from the package: a page is served until Ctrl-C.
cc -std=c99 -O2 -shared -fPIC -I"$tree/moved/include" "$examples/driver/rails.c" \
  -o "$tree/rails.so" || fail "the driver does not compile against the package"
"$tree/examples/06_serve_a_driver" "$tree/rails.so" >"$tree/served" 2>&1 &
serving=$!
for ((i = 0; i < 600; ++i)); do
  grep -qs console "$tree/served" && break
  kill -0 $serving 2>/dev/null || fail "$(cat "$tree/served")"
  sleep 0.1
done
url=$(grep -o 'http://[0-9.:]*' "$tree/served") || fail "$(cat "$tree/served")"
/usr/bin/python3 -c 'import sys, urllib.request as u; print(u.urlopen(sys.argv[1]).read().decode())' \
  "$url/metrics" >"$tree/metrics" || fail "nothing is served"
grep -q wholehand_ "$tree/metrics" || fail "$(cat "$tree/metrics")"
kill -TERM $serving  # a shell lets what it runs in the background ignore Ctrl-C
wait $serving || fail "$(cat "$tree/served")"
serving=
grep -q '0 sessions' "$tree/served" || fail "$(cat "$tree/served")"

# Every installed header stands in the installed folders, and of the vendors only Eigen shows.
(cd "$tree/moved/include" && find . -name '*.hpp' -printf '#include "%P"\n') >"$tree/all.cpp"
(($(wc -l <"$tree/all.cpp") > 20)) || fail "the headers are not installed"
"$compiler" -std=c++20 -I"$tree/moved/include" -I"$tree/moved/include/wholehand" \
  -isystem /usr/include/eigen3 -M "$tree/all.cpp" >"$tree/seen"
if grep -oE '[^ ]*/(bullet|mujoco|toml\+\+|hdf5|libqhull_r|tinyxml2|fmt|nlohmann|CLI|libpng16|boost|flatbuffers)(/|\.h)[^ ]*' \
  "$tree/seen"; then
  fail "vendors show in the public headers"
fi
# The malloc that counts must never reach a program that embeds us.
if nm -C --defined-only "$tree/out/consumer" | grep -E ' [TW] (malloc|free)$'; then
  fail "the consumer's malloc is replaced"
fi
