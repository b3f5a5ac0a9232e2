#!/usr/bin/env bash
# test_csharp.sh <source folder> <udp_stand_in> <folder to build in>: the C# client compiled by mono,
# its tests, and the client against a running process. 77: mono is not installed.
set -euo pipefail
source=$1 stand_in=$2 out=$3
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
mono --debug WholehandTests.exe "$stand_in"
