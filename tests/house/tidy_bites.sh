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
echo "$checks checks"
