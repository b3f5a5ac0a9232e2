#!/usr/bin/env bash
# A clang-tidy with an empty or misspelt list of checks passes everything, so this test needs its findings.
set -euo pipefail
# shellcheck source=tests/repository_rules/wrong.sh
source tests/repository_rules/wrong.sh
command -v clang-tidy >/dev/null || exit 77
checks=$(clang-tidy --list-checks | grep -c '^    ')
((checks >= 50)) || wrong "only $checks checks are enabled"
said=$(clang-tidy --quiet --config-file=.clang-tidy tests/repository_rules/bad_names.cpp -- -std=c++20 2>&1) &&
  wrong "clang-tidy finds nothing in tests/repository_rules/bad_names.cpp"
for name in bad_type BadFunction BadVariable member bad_constant badEnumerator; do
  grep -q "error: invalid case style for .* '$name'" <<<"$said" || wrong "clang-tidy did not find $name:" "$said"
done
for name in GoodType goodFunction good_variable good_member_ kGoodConstant kGood_ns; do
  if grep -q "'$name'" <<<"$said"; then wrong "clang-tidy dislikes $name:" "$said"; fi
done
# With its plugin, as in ./check, it finds the same.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/src"
cp tests/repository_rules/bad_names.cpp "$folder/src/bad.cpp"
# Headers of others are not checked, all of ours are.
mkdir "$folder/others"
printf 'struct names_of_others {};\n' >"$folder/others/others.hpp"
printf '#pragma once\n#include <others.hpp>\nstruct bad_type_of_a_header {};\n' >"$folder/src/ours.hpp"
for name in one two; do
  printf 'namespace {\nconstexpr int kSame = 1;\n}  // namespace\nint %s() { return kSame; }\n' "$name" \
    >"$folder/src/$name.cpp"
done
for name in bad one two; do
  printf '{"directory": "%s", "file": "%s", "command": "clang++ -std=c++20 -isystem %s -o x.o -c %s"}\n' \
    "$folder" "$folder/src/$name.cpp" "$folder/others" "$folder/src/$name.cpp"
done | sed -e '1s/^/[/' -e '$!s/$/,/' -e '$s/$/]/' >"$folder/compile_commands.json"
found=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src") &&
  wrong "tidy.py: nothing is found in tests/repository_rules/bad_names.cpp"
[[ $(grep -o "error: .*" <<<"$found") == "$(grep -o "error: .*" <<<"$said")" ]] ||
  wrong "tidy.py: something else is said of tests/repository_rules/bad_names.cpp:" "$found"
grep -qx '3 files looked at, 0 clean before, 1 with faults' <<<"$found" || wrong "tidy.py: $found"
cp "$folder/src/two.cpp" "$folder/two.cpp"
sed -i '1i #include "ours.hpp"' "$folder/src/two.cpp"
if said=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src"); then
  wrong "tidy.py: nothing is found in a header: $said"
fi
if ! grep -q "'bad_type_of_a_header'" <<<"$said" || grep -q names_of_others <<<"$said"; then
  wrong "tidy.py: something else is said of two headers: $said"
fi
mv "$folder/two.cpp" "$folder/src/two.cpp"
: >"$folder/src/bad.cpp"
python3 -B scripts/tidy.py "$folder" 2 "$folder/src" || wrong "tidy.py: clean files are refused"
printf 'namespace empty {}\nnamespace idle = empty;\n' >"$folder/src/one.cpp"
if said=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src"); then
  wrong "tidy.py: an alias that nobody uses was passed over: $said"
fi
: >"$folder/src/unknown.cpp"
if python3 -B scripts/tidy.py "$folder" 2 "$folder/src" 2>/dev/null; then
  wrong "tidy.py: a source that the build does not know was passed over"
fi
rm "$folder/src/unknown.cpp"
# A killed clang-tidy (out of memory, for example) has neither found nor passed anything.
mkdir "$folder/bin"
printf '#!/bin/bash\nkill -KILL $$\n' >"$folder/bin/clang-tidy"
chmod +x "$folder/bin/clang-tidy"
printf 'int changed();\n' >"$folder/src/one.cpp"
if said=$(PATH=$folder/bin:$PATH python3 -B scripts/tidy.py "$folder" 2 "$folder/src"); then
  wrong "a clang-tidy that was killed passed as clean: $said"
fi
grep -q 'clang-tidy was ended by SIGKILL' <<<"$said" || wrong "it is not said that clang-tidy was killed: $said"
# A killed file is checked again, a clean one is not.
said=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src")
grep -q '^1 files .* 2 clean before, 0 with faults$' <<<"$said" || wrong "after a change of one file of three: $said"
# The build precompiles headers and joins sources; a source without a needed #include is found here.
printf '#include <cstddef>\nstd::vector<int> forgot();\n' >"$folder/src/two.cpp"
if said=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src"); then
  wrong "a source without the #include that it needs was passed over: $said"
fi
grep -q "no template named 'vector'" <<<"$said" || wrong "the missing #include is not named: $said"
echo "$checks checks"
