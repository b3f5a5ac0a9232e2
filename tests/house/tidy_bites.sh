#!/usr/bin/env bash
# A clang-tidy whose list of checks is empty, or misspelt, passes everything: this one must bite.
set -euo pipefail
command -v clang-tidy >/dev/null || exit 77
checks=$(clang-tidy --list-checks | grep -c '^    ')
((checks >= 50)) || {
  echo "only $checks checks are enabled"
  exit 1
}
said=$(clang-tidy --quiet --config-file=.clang-tidy tests/house/bad_names.cpp -- -std=c++20 2>&1) && {
  echo "clang-tidy finds nothing in tests/house/bad_names.cpp"
  exit 1
}
for name in bad_type BadFunction BadVariable member bad_constant badEnumerator; do
  grep -q "error: invalid case style for .* '$name'" <<<"$said" || {
    echo "clang-tidy did not find $name:"
    echo "$said"
    exit 1
  }
done
for name in GoodType goodFunction good_variable good_member_ kGoodConstant kGood_ns; do
  if grep -q "'$name'" <<<"$said"; then
    echo "clang-tidy dislikes $name:"
    echo "$said"
    exit 1
  fi
done
# In batches, as ./check has it, it bites as well; sources with the same private names are parted.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/src"
cp tests/house/bad_names.cpp "$folder/src/bad.cpp"
for name in one two; do
  printf 'namespace {\nconstexpr int kSame = 1;\n}  // namespace\nint %s() { return kSame; }\n' "$name" \
    >"$folder/src/$name.cpp"
done
for name in bad one two; do
  printf '{"directory": "%s", "file": "%s", "command": "c++ -std=c++20 -o x.o -c %s"}\n' \
    "$folder" "$folder/src/$name.cpp" "$folder/src/$name.cpp"
done | sed -e '1s/^/[/' -e '$!s/$/,/' -e '$s/$/]/' >"$folder/compile_commands.json"
batched=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src") && {
  echo "batches: nothing is found in tests/house/bad_names.cpp"
  exit 1
}
[[ $(grep -o "error: .*" <<<"$batched") == "$(grep -o "error: .*" <<<"$said")" ]] || {
  echo "batches: something else is said of tests/house/bad_names.cpp:"
  echo "$batched"
  exit 1
}
grep -qx '3 files in 2 batches, 2 looked at alone, 1 with faults' <<<"$batched" || {
  echo "batches: $batched"
  exit 1
}
: >"$folder/src/bad.cpp"
python3 -B scripts/tidy.py "$folder" 2 "$folder/src" || {
  echo "batches: clean files are refused"
  exit 1
}
printf 'namespace empty {}\nnamespace idle = empty;\n' >"$folder/src/one.cpp"
if said=$(python3 -B scripts/tidy.py "$folder" 2 "$folder/src"); then
  echo "batches: an alias that nobody uses was passed over: $said"
  exit 1
fi
: >"$folder/src/unknown.cpp"
if python3 -B scripts/tidy.py "$folder" 2 "$folder/src" 2>/dev/null; then
  echo "batches: a source that the build does not know was passed over"
  exit 1
fi
echo "$checks checks"
