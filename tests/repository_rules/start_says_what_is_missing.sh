#!/usr/bin/env bash
# ./start on machines that lack something, simulated by stand-ins for apt-get, dpkg, node, npm and ninja on a separate
# PATH.
set -euo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
repo=$tree/repo bin=$tree/bin
mkdir -p "$repo/scripts" "$repo/protocol" "$repo/web/src" "$repo/build/release" "$bin"
cp start "$repo/"
cp scripts/lib.sh scripts/packages.txt scripts/step_costs.txt "$repo/scripts/"
mkdir -p "$repo/apps/wholehand/run" "$repo/apps/wholehand/shared"
cp apps/wholehand/run/run_command.cpp "$repo/apps/wholehand/run/"
cp apps/wholehand/shared/options.hpp "$repo/apps/wholehand/shared/"

stand_in() { # <program>, its script on standard input
  { echo '#!/bin/bash' && cat; } >"$bin/$1"
  chmod +x "$bin/$1"
}
for tool in bash env sed tr grep dirname readlink mkdir chmod cat tail tee touch nproc awk find flock sort; do
  ln -s "$(command -v "$tool")" "$bin/$tool" 2>/dev/null || true
done
# Reports the packages in the file as installed; one package was removed once.
stand_in dpkg-query <<EOF
while read -r p; do echo "installed \$p"; done <"$tree/installed"
echo "config-files zlib1g-dev"
EOF
stand_in dpkg <<EOF
[[ -f $tree/node-is-debians ]] && echo "nodejs: \$2"
EOF
stand_in apt-get <<EOF
echo "\$*" >>"$tree/apt-was-asked"
if [[ \$* == *install* && -x $tree/apt-installs ]]; then exec "$tree/apt-installs"; fi
echo "E: Failed to fetch: Temporary failure resolving" >&2
exit 100
EOF

start() { # [argument ...]: output of ./start in $said, and its status
  cd /
  said=$(PATH=$bin "$bin/bash" "$repo/start" "$@" </dev/null 2>&1)
}
wrong() {
  echo "$1; it said:"
  echo "$said"
  exit 1
}
expect() { grep -qF -- "$1" <<<"$said" || wrong "expected '$1'"; }
expect_line() { grep -qxF -- "$1" <<<"$said" || wrong "expected the line '$1'"; }
refuse() { ! grep -qF -- "$1" <<<"$said" || wrong "did not expect '$1'"; }
went_on() { start "$@" || wrong "./start $* ended with $?"; }

# Everything of [run] is installed except two packages: only these are requested, and ./start stops.
root=$PWD
# shellcheck source=scripts/lib.sh
source scripts/lib.sh
packages_of run | grep -vxF -e libfmt-dev -e zlib1g-dev >"$tree/installed"
if start; then wrong "./start went on without packages"; fi
expect_line 'Missing packages: libfmt-dev zlib1g-dev'
if ((EUID == 0)); then
  expect 'is there a network?'
  expect 'Temporary failure resolving'
  expect_line 'Still missing: libfmt-dev zlib1g-dev'
  expect_line 'Once there is one: apt-get update && apt-get install --no-install-recommends libfmt-dev zlib1g-dev'
else
  expect_line 'They need root and there is no sudo here. As root: apt-get install --no-install-recommends libfmt-dev zlib1g-dev'
fi

# Help and a wrong option are answered before anything is requested or built.
start --help || wrong "--help ended with $?"
expect '--exercise'
refuse 'Missing packages'
if start --no-such-option; then wrong "a wrong option was taken"; fi
expect 'has no option --no-such-option. It has: --address'
refuse 'Missing packages'
if start --seed -1 --port=0; then wrong "./start went on without packages"; fi
expect 'Missing packages'

# On another system nothing is installed: one line names it and the packages. Without the tools ./start stops.
printf 'PRETTY_NAME="Ubuntu 24.04 LTS"\nID=ubuntu\nVERSION_ID="24.04"\n' >"$tree/ubuntu"
export WHOLEHAND_OS_RELEASE=$tree/ubuntu
elsewhere="This is Ubuntu 24.04 LTS, not Debian 12; install with its own tools what Debian calls: $(packages_of run | tr '\n' ' ')"
if start; then wrong "./start went on without a compiler"; fi
expect_line "${elsewhere% }"
expect_line 'Missing here: clang++ cmake ninja git pkg-config flatc. Install them and start again (docs/platforms.md).'
refuse 'Missing packages'
unset WHOLEHAND_OS_RELEASE

# From here on all of [run] is installed and the program is built: it reports its arguments.
packages_of run >"$tree/installed"
echo "CMAKE_HOME_DIRECTORY:INTERNAL=$repo" >"$repo/build/release/CMakeCache.txt"
touch "$repo/build/release/build.ninja"
printf '#!/bin/bash\necho "wholehand $*"\n' >"$repo/build/release/wholehand"
chmod +x "$repo/build/release/wholehand"
stand_in ninja <<<'echo "ninja: no work to do."'
stand_in sudo <<'EOF'
[[ $1 == -n ]] && shift
case $1 in true) ;; *) exec "$@" ;; esac
EOF
touch -d 2020-01-01 "$repo/web/package.json" "$repo/web/package-lock.json" "$repo/web/src/main.ts" \
  "$repo/protocol/messages.fbs"
dist=$repo/web/dist/charts.html  # the last page that is built
node() { stand_in node <<<"echo $1"; }
npm_works() {
  cat <<EOF
#!/bin/bash
case \$1 in
  ci) mkdir -p node_modules && touch node_modules/.package-lock.json ;;
  run) mkdir -p dist && echo built | tee dist/index.html >dist/charts.html ;;
esac
EOF
}
afresh() { # no node, no npm, no pages, no network
  rm -rf "$bin/node" "$bin/npm" "$repo/web/dist" "$repo/web/node_modules" "$tree/apt-was-asked" \
    "$tree/apt-installs" "$tree/node-is-debians"
}
without_pages='Going on without pages: the address below says how to build them.'

for tool in clang++ cmake git pkg-config flatc; do stand_in "$tool" <<<'exit 0'; done
afresh # with the tools ./start goes on, also without node
WHOLEHAND_OS_RELEASE=$tree/ubuntu went_on --level 2
expect_line "${elsewhere% }"
expect_line "There is no node: the pages need $node_engines_in_words, and npm."
expect_line "$without_pages"
expect_line 'wholehand run --level 2'

if start --lab --level 2; then wrong "./start --lab went on without MuJoCo"; fi
expect_line 'Missing packages: libmujoco-dev'
afresh # no node, and none available
went_on --level 2
expect_line 'Missing packages: nodejs npm'
expect 'is there a network?'
expect_line "$without_pages"
expect_line 'wholehand run --level 2'

for version in v16.20.2 v18.18.2 v19.9.0 v21.7.3; do # none of these runs vite
  afresh
  node "$version"
  npm_works | stand_in npm
  went_on
  expect "Node $version ($bin/node) cannot build the pages: they need Node 18.19 or a later 18, any 20, or 22 and newer."
  expect_line "$without_pages"
  [[ ! -e $tree/apt-was-asked ]] || wrong "apt-get was asked"
done

afresh # node from another source, without npm: Debian's npm would remove it
node v20.11.1
went_on
expect "Node v20.11.1 ($bin/node) is there but its npm is not, and it is not Debian's. Install npm from where this node came."
expect_line "$without_pages"
[[ ! -e $tree/apt-was-asked ]] || wrong "apt-get was asked"

afresh # Debian's node without npm: Debian's npm is installed
node v18.19.0
touch "$tree/node-is-debians"
echo nodejs >>"$tree/installed"
{
  echo '#!/bin/bash' && echo "cat >$bin/npm <<'END'" && npm_works && echo END && echo "chmod +x $bin/npm"
} >"$tree/apt-installs"
chmod +x "$tree/apt-installs"
went_on
expect_line 'Missing packages: npm'
expect 'Building the pages ...'
expect_line 'wholehand run'
refuse 'Going on'
[[ $(cat "$dist") == built ]] || wrong "the pages are not built"

rm -r "$bin/node" "$bin/npm" "$tree/apt-was-asked" "$repo/web/node_modules" # the pages are current
went_on
[[ $said == 'wholehand run' ]] || wrong "pages that are current need neither node nor npm"
[[ ! -e $tree/apt-was-asked ]] || wrong "apt-get was asked"

touch -d 2020-01-02 "$dist" # older than a source, and npm cannot fetch
touch -d 2020-01-03 "$repo/web/src/main.ts"
node v22.1.0
stand_in npm <<<'echo "npm error network" >&2; exit 1'
went_on
expect 'npm error network'
expect_line 'Going on with the pages built before.'
expect_line 'wholehand run'
refuse 'Going on without pages'
[[ $(cat "$dist") == built ]] || wrong "the old pages are gone"
# A package with old pages would be wrong: without a network none is made, and the message says how to make it.
cp "$root/scripts/package.sh" "$repo/scripts/"
packages_of package >>"$tree/installed"
mkdir -p "$repo/build/packages"
if said=$(PATH=$bin "$bin/bash" "$repo/scripts/package.sh" </dev/null 2>&1); then wrong "packages were made"; fi
expect 'npm error network'
expect_line "Without one: copy the folder web/dist from a machine where these sources' pages were built."
[[ -z $(ls "$repo/build/packages") ]] || wrong "something was packed"
packages_of run >"$tree/installed"

afresh # a run without a port needs no pages; --port opens one even with a scene
for arguments in --simulated-clock '--scene a.toml' --scene=a.toml '--motion a.csv' --no-web; do
  read -ra words <<<"$arguments"
  went_on "${words[@]}"
  [[ $said == "wholehand run $arguments" ]] || wrong "./start $arguments needs no pages"
done
went_on --scene a.toml --port 0
expect_line "$without_pages"

# Building: a full disk, a moved tree, another build in the same tree, a missing compiler.
stand_in ninja <<'EOF'
echo "[1/2] Building CXX object a.o"
echo "FAILED: a.o"
echo "fatal error: error writing to /tmp/a.s: No space left on device"
exit 1
EOF
if start --no-web; then wrong "./start went on after a failed build"; fi
expect "Building release failed: the disk of $repo/build is full. Make room and start again"
stand_in ninja <<<'echo "ninja: no work to do."'

stand_in cmake <<EOF
echo "\$*" >>"$tree/cmake-was-asked"
EOF
echo "CMAKE_HOME_DIRECTORY:INTERNAL=/somewhere/else" >"$repo/build/release/CMakeCache.txt"
went_on --no-web
grep -q -- '--fresh --preset release' "$tree/cmake-was-asked" || wrong "a moved tree is not configured afresh"

stand_in cmake <<'EOF'
echo "CMake Error: No CMAKE_CXX_COMPILER could be found."
exit 1
EOF
if start --no-web; then wrong "./start went on without a compiler"; fi
expect 'No CMAKE_CXX_COMPILER could be found.'
expect 'Configuring release failed. Full log:'
echo "CMAKE_HOME_DIRECTORY:INTERNAL=$repo" >"$repo/build/release/CMakeCache.txt"

(
  exec 9>>"$repo/build/check.lock" && flock 9 && echo 4321 >"$repo/build/check.lock"
  if start --no-web; then wrong "two build into one folder"; fi
  expect "Another ./check or ./start builds in $repo (process 4321). Wait for it, or end it: kill 4321"
)
went_on --no-web

# One version range, also in npm's notation.
cd "$root"
# shellcheck disable=SC2154
grep -qF "\"node\": \"$node_engines\"" web/package.json || {
  echo "engines of web/package.json is not '$node_engines' as in scripts/lib.sh"
  exit 1
}
for version in v18.19.0 v18.20.4 v20.0.0 v22.0.0 v23.1.0 v24.1.0; do
  node_fits "$version" || { echo "$version is refused" && exit 1; }
done
for version in v8.17.0 v17.9.1 v18.18.9 v19.0.0 v21.0.0 ''; do
  if node_fits "$version"; then echo "$version is accepted" && exit 1; fi
done
