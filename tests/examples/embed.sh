#!/usr/bin/env bash
# embed.sh BUILD CONSUMER COMPILER: installs the package, then configures, builds and runs projects
# outside the tree that know only the location of the installation: a consumer, and the installed examples.
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
# Moves the installation: the package may not contain the path where it was installed or built.
mv "$tree/prefix" "$tree/moved"
grep -rlF -e "$build" -e "$tree/prefix" "$tree/moved" --include='*.cmake' --include='*.hpp' &&
  fail "these files name a folder of the build"

cp -r "$consumer" "$tree/consumer"
cmake -G Ninja -S "$tree/consumer" -B "$tree/out" -DCMAKE_PREFIX_PATH="$tree/moved" \
  -DCMAKE_CXX_COMPILER="$compiler" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
# Any warning is an error: the headers must compile without warnings in a stricter project.
cmake --build "$tree/out" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
"$tree/out/consumer"

examples=$tree/moved/share/doc/wholehand/examples
cmake -G Ninja -S "$examples" -B "$tree/examples" -DCMAKE_PREFIX_PATH="$tree/moved" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
cmake --build "$tree/examples" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
"$tree/examples/01_first_touch" >"$tree/touched" || fail "the first example does not run"
(($(wc -l <"$tree/touched") == 22)) || fail "$(cat "$tree/touched")"

# Uses one component: its packages are found, and HDF5 is not needed.
mkdir "$tree/rig"
cat >"$tree/rig/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(rig LANGUAGES CXX)
find_package(wholehand 0.1 CONFIG REQUIRED COMPONENTS rig)
add_executable(rig ${EXAMPLES}/08_rig_alone.cpp)
target_link_libraries(rig PRIVATE wholehand::rig)
target_compile_definitions(rig PRIVATE WHOLEHAND_SOURCE_DIR="${WHOLEHAND_SHARE_DIR}")
EOF
cmake -G Ninja -S "$tree/rig" -B "$tree/rig/out" -DCMAKE_PREFIX_PATH="$tree/moved" -DEXAMPLES="$examples" \
  -DCMAKE_CXX_COMPILER="$compiler" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
grep -qi hdf5 "$tree/rig/out/CMakeCache.txt" && fail "the component rig asks for HDF5"
cmake --build "$tree/rig/out" >"$tree/log" 2>&1 || fail "$(cat "$tree/log")"
"$tree/rig/out/rig" >"$tree/touched" || fail "the example of the component rig does not run"
sed -i 's/COMPONENTS rig/COMPONENTS rigs/' "$tree/rig/CMakeLists.txt"
cmake -S "$tree/rig" -B "$tree/rig/unknown" -DCMAKE_PREFIX_PATH="$tree/moved" -DEXAMPLES="$examples" \
  >"$tree/log" 2>&1 && fail "a component that does not exist was found"
grep -q 'there is no component rigs' "$tree/log" || fail "$(cat "$tree/log")"

# Runs driver, station and server from the package and serves a page until Ctrl-C.
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
kill -TERM $serving  # a shell makes its background processes ignore Ctrl-C
wait $serving || fail "$(cat "$tree/served")"
serving=
grep -q '0 sessions' "$tree/served" || fail "$(cat "$tree/served")"

# Every header compiles with the installed folders alone, and of the vendors only Eigen is visible.
(cd "$tree/moved/include" && find . -name '*.hpp' -printf '#include "%P"\n') >"$tree/all.cpp"
(($(wc -l <"$tree/all.cpp") > 20)) || fail "the headers are not installed"
"$compiler" -std=c++20 -I"$tree/moved/include" -I"$tree/moved/include/wholehand" \
  -isystem /usr/include/eigen3 -M "$tree/all.cpp" >"$tree/seen"
if grep -oE '[^ ]*/(bullet|mujoco|toml\+\+|hdf5|libqhull_r|tinyxml2|fmt|nlohmann|CLI|libpng16|boost|flatbuffers)(/|\.h)[^ ]*' \
  "$tree/seen"; then
  fail "vendors show in the public headers"
fi
# The counting malloc must never be linked into a program that embeds the library.
if nm -C --defined-only "$tree/out/consumer" | grep -E ' [TW] (malloc|free)$'; then
  fail "the consumer's malloc is replaced"
fi
