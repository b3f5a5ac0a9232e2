#!/usr/bin/env bash
# test_csharp.sh <source folder> <folder to build in> <udp_stand_in> [wholehand]: the C# client compiled
# by mono, its tests, and the client against running processes. 77: mono is not installed.
set -euo pipefail
source=$1 out=$2
shift 2
for tool in mcs mono; do
  command -v "$tool" >/dev/null || {
    echo "skipped: $tool is not installed (mono-mcs, mono-runtime)"
    exit 77
  }
done
"$source/clients/csharp/build.sh" "$out"
cd "$out"
mcs -langversion:7 -debug -nologo -warn:4 -warnaserror -r:Wholehand.Protocol.dll \
  -r:Wholehand.Client.dll -out:WholehandTests.exe "$source"/tests/clients/csharp/*.cs
export WHOLEHAND_AXES_PAGE=$source/docs/axes.md WHOLEHAND_GAME_TABLE=$source/tests/clients/game_table.toml
mono --debug WholehandTests.exe "$@"
