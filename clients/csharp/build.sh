#!/usr/bin/env bash
# clients/csharp/build.sh [folder]: builds Wholehand.Client.dll, WatchHand.exe and the tests with
# mono's compiler into the folder (build/csharp). Needs the packages mono-mcs, flatbuffers-compiler
# and, the first time, a network.
set -euo pipefail

here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
root=$(cd "$here/../.." && pwd)
out=$(realpath -m "${1:-$root/build/csharp}")
runtime=$root/build/flatbuffers-csharp

for tool in mcs flatc; do
  command -v "$tool" >/dev/null || {
    echo "$tool is missing: install $([[ $tool == mcs ]] && echo mono-mcs || echo flatbuffers-compiler)" >&2
    exit 1
  }
done
"$root/scripts/fetch_flatbuffers_csharp.sh" "$runtime"
mkdir -p "$out"
flatc --csharp --gen-onefile -o "$out" "$root/protocol/wholehand.fbs"
# Unity takes C# 7 and .NET Standard 2.0; our files are held to every warning, others' to none.
compile() { mcs -langversion:7 -debug -nologo "$@"; }
cd "$out"
compile -target:library -warn:0 -out:Wholehand.Protocol.dll "$runtime"/*.cs wholehand_generated.cs
compile -target:library -warn:4 -warnaserror -r:Wholehand.Protocol.dll -out:Wholehand.Client.dll \
  "$here"/Wholehand/*.cs
compile -warn:4 -warnaserror -r:Wholehand.Protocol.dll -r:Wholehand.Client.dll -out:WatchHand.exe \
  "$here"/WatchHand/*.cs
