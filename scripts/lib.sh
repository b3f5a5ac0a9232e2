# shellcheck shell=bash
# Functions of ./start and ./check. Sourced, not run.

root=${root:?the folder of the repository}

say() { printf '%s\n' "$*"; }
fail() {
  printf '%s\n' "$*" >&2
  exit 1
}

# Prints seconds in words: 7 s, 2 min 05 s.
duration() {
  if (($1 < 60)); then printf '%d s' "$1"; else printf '%d min %02d s' $(($1 / 60)) $(($1 % 60)); fi
}

# Prints the names of packages in the given sections of scripts/packages.txt, each once.
packages_of() {
  local section line listed=" " wanted=" $* "
  while read -r line _; do
    case $line in
      '' | \#*) ;;
      \[*\]*) section=${line#[} section=${section%%]*} ;;
      *)
        [[ $wanted == *" $section "* && $listed != *" $line "* ]] || continue
        printf '%s\n' "$line"
        listed+="$line "
        ;;
    esac
  done <"$root/scripts/packages.txt"
  return 0
}

# Prints those of the given packages that are not installed.
missing_packages() {
  local installed
  installed=" $(dpkg-query -W -f='${db:Status-Status} ${Package}\n' 2>/dev/null |
    sed -n 's/^installed //p' | tr '\n' ' ') "
  local package
  for package in "$@"; do
    [[ $installed == *" $package "* ]] || printf '%s\n' "$package"
  done
}

# The name of this system, and true if it is Debian 12. Tests name another file.
system_name=$(sed -n 's/^PRETTY_NAME="\{0,1\}\([^"]*\)"\{0,1\}$/\1/p' "${WHOLEHAND_OS_RELEASE:-/etc/os-release}" 2>/dev/null) || true
is_debian_12() {
  local -A of=()
  local key value
  while IFS='=' read -r key value; do of[$key]=${value//\"/}; done 2>/dev/null <"${WHOLEHAND_OS_RELEASE:-/etc/os-release}"
  [[ ${of[ID]:-} == debian && ${of[VERSION_ID]:-} == 12 ]]
}

# go_on_elsewhere <package ...>: on another system nothing is installed; continues if the tools are there.
go_on_elsewhere() {
  local tool missing=()
  say "This is ${system_name:-no system with /etc/os-release}, not Debian 12; install with its own tools what Debian calls: $*"
  for tool in clang++ cmake ninja git pkg-config flatc; do
    command -v "$tool" >/dev/null || missing+=("$tool")
  done
  ((${#missing[@]} == 0)) || fail "Missing here: ${missing[*]}. Install them and start again (docs/platforms.md)."
}

# Installs the missing packages of the given sections, or prints what to do and ends.
install_packages() {
  local wanted missing as_root=()
  mapfile -t wanted < <(packages_of "$@")
  if ! is_debian_12; then go_on_elsewhere "${wanted[@]}" && return; fi
  mapfile -t missing < <(missing_packages "${wanted[@]}")
  ((${#missing[@]} == 0)) && return
  local command="apt-get install --no-install-recommends ${missing[*]}"
  say "Missing packages: ${missing[*]}"
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      fail "They need root and there is no sudo here. As root: $command"
    as_root=(sudo)
    # Without a terminal nobody could type a password.
    [[ -t 0 ]] || sudo -n true 2>/dev/null || fail "They need root. Run: sudo $command"
  fi
  local log="$root/build/logs/packages.log" start=$SECONDS
  make_log "$log"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q
    -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o Acquire::https::Timeout=20
    -o DPkg::Lock::Timeout=120)
  say "Reading the package lists ..."
  "${apt[@]}" update >"$log" 2>&1 || true
  say "Installing ${#missing[@]} packages (log: $log) ..."
  if ! "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >>"$log" 2>&1; then
    tail -n 15 "$log" >&2
    mapfile -t missing < <(missing_packages "${wanted[@]}")
    fail "
The packages could not be installed; is there a network?
Still missing: ${missing[*]}
Once there is one: ${as_root[*]:+sudo }apt-get update && ${as_root[*]:+sudo }$command
Full log: $log"
  fi
  say "Installed in $(duration $((SECONDS - start)))."
}

# Prints the name of a clang with RealtimeSanitizer (20 or newer, with its runtime).
realtime_clang() {
  local clang version
  for clang in clang++ clang++-{20..40}; do
    version=$("$clang" -dumpversion 2>/dev/null) || continue
    if ((${version%%.*} >= 20)) &&
      "$clang" -fsanitize=realtime -x c++ -o /dev/null - <<<'int main() {}' 2>/dev/null; then
      printf '%s\n' "$clang"
      return
    fi
  done
  return 1
}

# Node versions that vite 6 supports. web/package.json has the same line; a test compares them.
# shellcheck disable=SC2034
node_engines='^18.19.0 || ^20.0.0 || >=22.0.0'
node_engines_in_words='Node 18.19 or a later 18, any 20, or 22 and newer'
node_fits() { # <version as node prints it>
  [[ $1 =~ ^v?([0-9]+)\.([0-9]+) ]] || return 1
  local major=${BASH_REMATCH[1]} minor=${BASH_REMATCH[2]}
  ((major == 18 && minor >= 19 || major == 20 || major >= 22))
}

# True when node and npm are installed and have a suitable version, from any source.
have_node() {
  hash -r # they may have just been installed
  command -v npm >/dev/null && node_fits "$(node --version 2>/dev/null)"
}

# Debian's npm conflicts with nodejs from other sources. It is installed only if node comes from Debian, or if there is
# no node.
install_node() {
  have_node && return
  local node version
  if node=$(command -v node); then
    version=$(node --version 2>/dev/null) || version="that does not start"
    node_fits "$version" ||
      fail "Node $version ($node) cannot build the pages: they need $node_engines_in_words. Install one of these from where this one came, or remove it and Debian's is installed."
    dpkg -S "$(readlink -f "$node")" >/dev/null 2>&1 ||
      fail "Node $version ($node) is there but its npm is not, and it is not Debian's. Install npm from where this node came."
  fi
  is_debian_12 || fail "There is no node: the pages need $node_engines_in_words, and npm."
  install_packages web
  have_node || fail "What Debian installed cannot build the pages: they need $node_engines_in_words, and npm."
}

# npm_install: installs the packages of web/package-lock.json if they are missing or old.
npm_install() {
  local stamp="$root/web/node_modules/.package-lock.json" log="$root/build/logs/npm.log"
  [[ $stamp -nt $root/web/package-lock.json ]] && return
  make_log "$log"
  say "Fetching what the pages are made of (npm, log: $log) ..."
  local start=$SECONDS
  if ! (cd "$root/web" && npm ci) >"$log" 2>&1; then
    tail -n 15 "$log" >&2
    say "The npm packages could not be fetched; is there a network? Full log: $log" >&2
    say "Without one: copy the folder web/dist from a machine where these sources' pages were built." >&2
    return 1
  fi
  touch "$stamp"
  say "Fetched in $(duration $((SECONDS - start)))."
}

# True when the built pages are newer than all their sources.
pages_are_current() {
  [[ -f $root/web/dist/index.html && -f $root/web/dist/charts.html ]] || return 1
  local newer  # a source newer than the charts, which are built last
  newer=$(cd "$root" && find web protocol \( -path web/node_modules -o -path web/dist -o -path web/tests \
    -o -path web/test-output -o -path web/src/protocol/generated \) -prune \
    -o -type f -newer web/dist/charts.html -print -quit) && [[ -z $newer ]]
}

# build_web: builds the pages into web/dist if a source is newer.
build_web() {
  local log="$root/build/logs/web.log" start=$SECONDS
  npm_install || return 1
  if pages_are_current; then return; fi
  make_log "$log"
  say "Building the pages ..."
  if ! (cd "$root/web" && npm run build) >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    say "The pages could not be built. Full log: $log" >&2
    return 1
  fi
  say "Built in $(duration $((SECONDS - start)))."
}

# begin_pages: for ./start, which continues even if this fails. Current pages need no node. Steps that may ask for a
# password run first; the rest runs in the background as the process $pages.
begin_pages() {
  pages_are_current && return
  make_log "$root/build/logs/pages.log"
  if ((EUID == 0)); then  # no password is needed
    (install_node && build_web) >"$root/build/logs/pages.log" 2>&1 &
    pages=$!
  elif (install_node); then
    build_web >"$root/build/logs/pages.log" 2>&1 &
    pages=$!
  else
    pages=none
  fi
}

# finish_pages: waits for the process of begin_pages, and prints its result.
finish_pages() {
  if [[ -z $pages ]]; then return; fi
  local built=0
  if [[ $pages != none ]] && wait "$pages"; then built=1; fi
  cat "$root/build/logs/pages.log"
  if ((built)); then return; fi
  if [[ -f $root/web/dist/index.html ]]; then
    say "Going on with the pages built before."
  else
    say "Going on without pages: the address below says how to build them."
  fi
}

# needs_pages <arguments of wholehand run>: false when no port is opened.
needs_pages() {
  local argument scene=0 port=0
  for argument in "$@"; do
    case $argument in
      --no-web | --simulated-clock) return 1 ;;
      --scene | --scene=* | --motion | --motion=*) scene=1 ;;
      --port | --port=*) port=1 ;;
    esac
  done
  ((!scene || port))
}

# answer_at_once <arguments of ./start>: answers --help, and refuses options that `wholehand run` does not have, without
# a build. The options are read from the program's sources.
answer_at_once() {
  local argument options
  options=$(grep -ohE '"--[a-z][a-z-]*' "$root"/apps/wholehand/{run/run_command.cpp,shared/options.hpp} | tr -d '"' | sort -u)
  for argument in "$@"; do
    argument=${argument%%=*}
    case $argument in
      -h | --help)
        say "usage: ./start [--lab] [options of \`wholehand run\`]: installs what is missing, builds, opens the cocktail bar."
        if [[ -x $root/build/release/wholehand ]]; then exec "$root/build/release/wholehand" run --help; fi
        say './start --help explains each option once the program is built; so does docs/program.md:'
        # shellcheck disable=SC2086
        printf '  %s\n' $options
        exit 0
        ;;
      -*)
        if [[ ! $argument =~ ^-[0-9.] ]] && ! grep -qxF -- "$argument" <<<"$options"; then
          say "./start: \`wholehand run\` has no option $argument. It has: ${options//$'\n'/ }" >&2
          exit 2
        fi
        ;;
    esac
  done
}

cannot_write="Cannot write to $root/build. Clone as the user who builds, or: chown -R \"\$USER\" \"$root\""
disk_is_full="the disk of $root/build is full. Make room and start again: what is done is kept."
make_log() {
  { mkdir -p "$(dirname "$1")" && : >"$1"; } 2>/dev/null && return
  if out_of_space; then fail "Cannot write to $root/build: $disk_is_full"; fi
  fail "$cannot_write"
}

# out_of_space [log]: true when a step failed because the disk is full, judged by its log or, if even that is missing,
# by the free space.
out_of_space() {
  local free_kb
  if [[ -n ${1:-} ]] && grep -qi 'no space left on device' "$1"; then return; fi
  free_kb=$(df --output=avail -k "$root/build" 2>/dev/null | tail -n 1)
  ((${free_kb:-1000000} < 4096))
}

# one_at_a_time: takes a lock, because two builds in the same folder would disturb each other.
one_at_a_time() {
  local lock="$root/build/check.lock"
  mkdir -p "$root/build" 2>/dev/null || true
  { exec 9>>"$lock"; } 2>/dev/null || fail "$cannot_write"
  flock -n 9 || fail \
    "Another ./check or ./start builds in $root (process $(cat "$lock")). Wait for it, or end it: kill $(cat "$lock")"
  echo $$ >"$lock"
}

# Prints the number of parallel compilers: one per core, or $build_cores, but at most one per 1.5 GB of free memory.
build_jobs() {
  local cores free_kb jobs
  cores=${build_cores:-$(nproc)}
  free_kb=$(sed -n 's/^MemAvailable: *\([0-9]*\).*/\1/p' /proc/meminfo)
  jobs=$((${free_kb:-99000000} / 1500000))
  if ((jobs < 1)); then jobs=1; fi
  echo $((jobs < cores ? jobs : cores))
}

# configure <preset> [cmake arguments]: configures a build. A build folder that was moved, is incomplete or belongs to
# another compiler is configured from scratch.
configure() {
  local preset=$1 folder="$root/build/$1" log="$root/build/logs/configure-$1.log" fresh=()
  shift
  make_log "$log"
  if [[ -f $folder/CMakeCache.txt ]] &&
    ! { grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt" &&
      grep -q '^CMAKE_CXX_COMPILER:[A-Z]*=.*clang++' "$folder/CMakeCache.txt"; }; then
    fresh=(--fresh)
  fi
  # ccache cannot cache objects built with precompiled headers, so these are switched off.
  if [[ $preset != analysis ]] && command -v ccache >/dev/null; then
    set -- "$@" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DWHOLEHAND_PRECOMPILED=OFF
  fi
  if ! (cd "$root" && cmake "${fresh[@]}" --preset "$preset" "$@") >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    if out_of_space "$log"; then fail "Configuring $preset failed: $disk_is_full Full log: $log"; fi
    fail "Configuring $preset failed. Full log: $log"
  fi
}

# Cost of each step of a release build, in tenths of a second on some machine, written by scripts/build_times.py --costs.
# Only ratios matter, for the remaining time. A step that is not listed costs $usual_cost.
declare -A step_cost=()
usual_cost=20
read_step_costs() {
  local cost output
  while read -r cost output; do step_cost[$output]=$cost; done <"$root/scripts/step_costs.txt"
}

# cost_of_build <preset> <target ...>: prints the sum of the costs of all steps that the targets need now.
cost_of_build() {
  local line sum=0 folder=$root/build/$1
  shift
  # Under another name the build file has no rule that writes it anew, which is all that a dry run of it would list.
  cp "$folder/build.ninja" "$folder/steps.ninja"
  while IFS= read -r line; do
    [[ $line =~ ^\[[0-9]+/[0-9]+\] ]] && sum=$((sum + ${step_cost[${line##* }]:-$usual_cost}))
  done < <(ninja -C "$folder" -f steps.ninja -n "$@" 2>/dev/null)
  echo "$sum"
}

# show_progress <what> <cost of all steps>: on a terminal, one line that is updated; elsewhere a line every tenth of the
# way. The remaining time is estimated after a minute of compiling, by the costs of the steps.
show_progress() {
  local line done_ of name tenth last=-1 terminal=0 compiling=0 reported=0 left="" spent=0
  local start=$SECONDS took
  [[ -t 1 ]] && terminal=1
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    # Builds that only write the version of the sources are not reported.
    if ((!compiling)) && [[ $line == *'] Building '* ]]; then
      compiling=1 start=$SECONDS
      say "$1: ${BASH_REMATCH[2]} steps ..."
    fi
    done_=${BASH_REMATCH[1]} of=${BASH_REMATCH[2]} tenth=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
    spent=$((spent + ${step_cost[${line##* }]:-$usual_cost}))
    if ((!compiling)); then continue; fi
    took=$((SECONDS - start))
    if ((took >= 60 && spent > 0 && $2 >= spent)); then left=", about $(duration $((took * ($2 - spent) / spent))) left"; fi
    if ((terminal)); then
      name=${line##*/}
      printf '\r%s: %d of %d%s, %.40s\033[K' "$1" "$done_" "$of" "$left" "${name%.o}"
    elif ((of > 10 && tenth != last || took >= 60 && !reported)); then
      printf '%s: %d of %d%s\n' "$1" "$done_" "$of" "$left"
    fi
    if ((took >= 60)); then reported=1; fi
    last=$tenth
  done
  if ((terminal)); then printf '\r\033[K'; fi
}

# build <preset> <target ...>: builds the targets.
build() {
  local preset=$1 log="$root/build/logs/build-$1.log" start=$SECONDS jobs all
  shift
  make_log "$log"
  jobs=$(build_jobs)
  read_step_costs
  all=$(cost_of_build "$preset" "$@") || all=0 # the build says what is wrong
  if ! ninja -C "$root/build/$preset" -j "$jobs" "$@" 2>&1 | tee "$log" |
    show_progress "Building $preset" "$all"; then
    if out_of_space "$log"; then fail "Building $preset failed: $disk_is_full Full log: $log"; fi
    grep -vE '^(\[|ninja: )' "$log" | grep -E -A12 -m3 '^FAILED|error|Error' >&2 ||
      tail -n 30 "$log" >&2
    fail "Building $preset failed. Full log: $log"
  fi
  if grep -q '\] Building ' "$log"; then say "Built in $(duration $((SECONDS - start)))."; fi
}

# make_packages: makes build/packages/*.deb from the release build and its pages, and checks them with lintian.
make_packages() {
  local log="$root/build/logs/cpack.log"
  rm -rf "$root/build/packages"
  make_log "$log"
  if ! { python3 "$root/scripts/check_versions.py" &&
    python3 "$root/packaging/write_papers.py" "$root/build/release" &&
    cpack --config "$root/build/release/CPackConfig.cmake" -B "$root/build/packages"; } >"$log" 2>&1; then
    tail -n 20 "$log"
    rm -rf "$root/build/packages" # incomplete
    fail "No packages were made; full log: $log"
  fi
  rm -rf "$root/build/packages/_CPack_Packages"
  lintian --no-cfg --fail-on error,warning --tag-display-limit 0 "$root"/build/packages/*.deb
}
