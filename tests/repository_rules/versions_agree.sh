#!/usr/bin/env bash
# All versions written by hand agree; any that does not is named with both values.
set -euo pipefail
python3 scripts/check_versions.py
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
files=(CITATION.cff CHANGELOG.md web/package.json clients/unity/org.wholehand.client/package.json
  clients/unity/org.wholehand.client/CHANGELOG.md clients/godot/addons/wholehand/plugin.cfg
  clients/python/wholehand/__init__.py)
cp --parents CMakeLists.txt "${files[@]}" "$copy"
for file in "${files[@]}"; do
  version=$(sed -n 's/^project(wholehand VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
  sed -i "s/${version//./\\.}/9.8.7/" "$copy/$file"
  said=$(python3 scripts/check_versions.py "$copy") && status=0 || status=$?
  expected="$copy/$file: the version is 9.8.7, that of $copy/CMakeLists.txt is $version; write $version there"
  if [[ $status != 1 || $said != "$expected" ]]; then
    printf 'a wrong version in %s gave %s and:\n%s\nnot 1 and:\n%s\n' "$file" "$status" "$said" "$expected"
    exit 1
  fi
  cp "$file" "$copy/$file"
done
rm "$copy/CITATION.cff"
said=$(python3 scripts/check_versions.py "$copy" 2>&1) && exit 1
[[ $said == "$copy/CITATION.cff: No such file or directory" ]] || { echo "$said" && exit 1; }
