#!/usr/bin/env bash
# Every relative link and image of a tracked Markdown file leads to an existing, tracked file.
set -euo pipefail
[[ -e .git ]] || exit 77
python3 - <<'EOF'
import os, re, subprocess, sys

def tracked(*patterns):
    command = ["git", "-c", "safe.directory=" + os.getcwd(), "ls-files", "-z", *patterns]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split("\0")[:-1]

files = set(tracked())
folders = {""}
for name in files:
    while name := os.path.dirname(name):
        folders.add(name)
links, broken = 0, []
for page in tracked("*.md"):
    if not os.path.exists(page):
        continue
    with open(page, encoding="utf-8") as f:
        text = re.sub(r"^```.*?^```", "", f.read(), flags=re.M | re.S)  # code shows links but contains none
    targets = re.findall(r"\]\(\s*<?([^)>\s]+)[^)]*\)", text)
    targets += re.findall(r"""<(?:img|a)\s[^>]*(?:src|href)=["']([^"']+)""", text)
    for target in targets:
        path = target.split("#")[0].split("?")[0]
        if not path or re.match(r"[a-z][a-z0-9+.-]*:", path):
            continue
        links += 1
        full = os.path.normpath(os.path.join(os.path.dirname(page), path))
        full = "" if full == "." else full
        if full not in files and full not in folders:
            broken.append(f"{page}: {target}" + (" is not tracked" if os.path.exists(full) else " is not there"))
print("\n".join(broken) or f"{links} links")
if links < 20:
    sys.exit(f"only {links} links were found: they are not read any more")
sys.exit(1 if broken else 0)
EOF
