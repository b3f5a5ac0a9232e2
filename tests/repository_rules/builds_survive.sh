#!/usr/bin/env bash
# Builds of scripts/lib.sh under adverse conditions: a path with spaces, a build killed half way, a moved tree, a full
# disk, a missing compiler, a second build in the same tree.
set -euo pipefail
folder=$(mktemp -d)
disk=$folder/disk
trap 'umount "$disk" 2>/dev/null || true; rm -rf "$folder"' EXIT
# shellcheck source=tests/repository_rules/wrong.sh
source tests/repository_rules/wrong.sh

# Copies enough of the tree to configure all of it. One small library is built.
copy_tree() { # <to>
  mkdir -p "$1"
  git ls-files -z -- CMakeLists.txt CMakePresets.json LICENSE cmake protocol clients src include drivers experiments apps \
    packaging data scripts start check | tar --null -T - -c | tar -x -C "$1"
}
target=wholehand_files_page
# in_tree <tree> <command ...>: runs it as ./start and ./check do.
in_tree() {
  # shellcheck disable=SC2016
  CCACHE_DISABLE=1 bash -c 'set -euo pipefail; root=$1; shift; cd "$root"; source scripts/lib.sh; "$@"' lib "$@" 2>&1
}
cost_of_target() { in_tree "$1" cost_of_build release "$target"; } # <tree>
build_it() { # <tree>
  local said
  said=$(in_tree "$1" configure release -DWHOLEHAND_BUILD_TESTS=OFF) || wrong "not configured in $1" "$said"
  said=$(in_tree "$1" build release "$target") || wrong "not built in $1" "$said"
}
objects() { # <tree>: the sums of all that was compiled
  (cd "$1/build/release" && find . \( -name '*.o' -o -name '*.a' \) -print0 | sort -z | xargs -0 sha256sum)
}

# A path with spaces. Its complete build is the reference for the killed builds.
tree="$folder/a tree"
copy_tree "$tree"
build_it "$tree"
whole=$(objects "$tree")
[[ -n $whole ]] || wrong "nothing was built in '$tree'"

# Kills the build half way, three times, at different points.
rm -rf "$tree/build"
in_tree "$tree" configure release -DWHOLEHAND_BUILD_TESTS=OFF >/dev/null
# The time that is left is estimated from the costs of all steps, also right after configuring. The target has more than
# ten; each costs at least 1.
((cold = $(cost_of_target "$tree"), cold > 10)) || wrong "a cold build is estimated by $cold"
for seconds in 0.5 1.2 2.1; do
  # shellcheck disable=SC2016
  setsid bash -c 'root=$0; cd "$root"; source scripts/lib.sh; build release "$1"' "$tree" "$target" >"$folder/killed.log" 2>&1 &
  killed=$!
  sleep "$seconds"
  kill -KILL -- "-$killed" || wrong "the build had ended before it was killed" "$(cat "$folder/killed.log")"
  wait "$killed" 2>/dev/null || true
done
build_it "$tree"
((4 * $(cost_of_target "$tree") < cold)) || wrong "a finished build is estimated by more than a quarter of a cold one"
[[ $(objects "$tree") == "$whole" ]] || wrong "after three killed builds something else is built"

# Two builds at once: the second one names the first.
exec 8>>"$tree/build/check.lock"
flock -n 8
echo $$ >"$tree/build/check.lock"
if said=$(in_tree "$tree" one_at_a_time); then wrong "two build in one tree"; fi
[[ $said == *"Another ./check or ./start builds in $tree (process $$)"* ]] || wrong "the first is not named" "$said"
exec 8>&-

# Moved to another folder: it is configured again and built there.
moved="$folder/moved"
mv "$tree" "$moved"
build_it "$moved"
grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$moved" "$moved/build/release/CMakeCache.txt" || wrong "the old folder is kept"

# No compiler.
bin=$folder/bin
mkdir "$bin"
for place in /usr/bin /bin; do
  for program in "$place"/*; do
    case ${program##*/} in
      clang* | ccache) ;;
      *) ln -sf "$program" "$bin/" ;;
    esac
  done
done
rm "$moved/build/release/CMakeCache.txt"
if said=$(PATH=$bin in_tree "$moved" configure release); then wrong "configured without a compiler"; fi
[[ $said == *clang* && $said == *"Configuring release failed. Full log: $moved/build/logs/configure-release.log"* ]] ||
  wrong "the missing compiler is not named" "$said"

# A full disk. Without root it cannot be mounted; the rest has passed by then.
mkdir "$disk"
if ! mount -t tmpfs -o size=40m tmpfs "$disk" 2>/dev/null; then
  echo "no disk can be mounted here: a full one was not tried"
  exit 0
fi
copy_tree "$disk/tree"
in_tree "$disk/tree" configure release -DWHOLEHAND_BUILD_TESTS=OFF >/dev/null
head -c 100M /dev/zero >"$disk/filler" 2>/dev/null || true
if said=$(in_tree "$disk/tree" build release "$target"); then wrong "a full disk stopped no build"; fi
[[ $said == *"the disk of $disk/tree/build is full. Make room and start again"* ]] || wrong "the full disk is not named" "$said"
rm "$disk/filler"
mount -o remount,size=400m "$disk"
build_it "$disk/tree"
echo "passed"
