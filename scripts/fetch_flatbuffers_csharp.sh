#!/usr/bin/env bash
# scripts/fetch_flatbuffers_csharp.sh <folder>: writes the C# runtime of FlatBuffers to <folder>/*.cs. Debian has it
# only in the source package. It is fetched through apt from the package sources of this machine; nothing on the machine
# is changed and no rights are needed. A folder that already holds the version of the installed flatc is left unchanged.
set -euo pipefail

fail() {
  printf '%s\n' "$*" >&2
  exit 1
}
[[ $# == 1 ]] || fail "usage: scripts/fetch_flatbuffers_csharp.sh <folder>"
target=$(realpath -m "$1")
command -v apt-get >/dev/null || fail "This is no Debian: there is no apt-get to fetch the C# runtime of
FlatBuffers with. Put net/FlatBuffers/*.cs of the version of your flatc into $target."
for tool in flatc tar xz flock; do
  command -v "$tool" >/dev/null || fail "$tool is missing: scripts/packages.txt names its package."
done
version=$(flatc --version | sed 's/^flatc version //')
constant="FLATBUFFERS_${version//./_}()"

complete() { grep -qsF "$constant" "$target/FlatBufferConstants.cs" && [[ -f $target/Table.cs ]]; }

mkdir -p "$(dirname "$target")"
# Several tests may run this at the same time.
exec 9>"$target.lock"
flock 9
if complete; then exit 0; fi

work=$(mktemp -d "$target.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{parts,lists/partial,cache/archives/partial,source,runtime}
# Package sources of this machine, with source packages enabled: old one-line files and deb822.
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  if [[ -e $list ]]; then
    sed -nE 's/^deb([[:space:]])/deb-src\1/p' "$list" >"$work/parts/${list##*/}.list"
  fi
done
for list in /etc/apt/sources.list.d/*.sources; do
  if [[ -e $list ]]; then
    sed 's/^Types:.*/Types: deb-src/' "$list" >"$work/parts/${list##*/}"
  fi
done
apt=(apt-get -q -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/parts"
  -o Dir::State::Lists="$work/lists" -o Dir::Cache="$work/cache"
  -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o Acquire::https::Timeout=20
  -o Acquire::Languages=none)
# As root, apt would download as a user who may not write here.
if ((EUID == 0)); then apt+=(-o APT::Sandbox::User=root); fi

cd "$work/source"
# Other package sources of the machine may fail to update; only this package matters.
"${apt[@]}" update >"$work/log" 2>&1 || true
if ! "${apt[@]}" source --download-only flatbuffers >>"$work/log" 2>&1; then
  tail -n 8 "$work/log" >&2
  fail "
The source package flatbuffers could not be fetched, which holds the C# runtime of FlatBuffers.
Is there a network, and does this machine's mirror (/etc/apt/sources.list.d) carry source packages?
Without them: put net/FlatBuffers/*.cs of FlatBuffers $version into $target."
fi
tar xJf flatbuffers_*.orig.tar.xz -C "$work/runtime" --strip-components=3 --no-same-owner \
  --wildcards --no-wildcards-match-slash '*/net/FlatBuffers/*.cs' ||
  fail "The source package flatbuffers holds no C# runtime any more."
grep -qF "$constant" "$work/runtime/FlatBufferConstants.cs" ||
  fail "The source package flatbuffers ($(ls ./*.dsc)) is not of version $version, which flatc has."
rm -rf "$target"
mv "$work/runtime" "$target"
