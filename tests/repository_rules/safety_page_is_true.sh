#!/usr/bin/env bash
# docs/safety.md has a row for every bit of Fault, with the reaction of the table in the code. Every hazard names a
# test, and every named test exists in the file that it links. A page with one false name must be noticed.
set -euo pipefail
judge() {
  python3 - "$1" <<'EOF'
import os, re, sys

page = open(sys.argv[1], encoding="utf-8").read()
wrong = []
bits = re.findall(r"^\s+(k\w+) =\s+1U << \d+", open("src/loop/core/fault.hpp", encoding="utf-8").read(), re.M)
if len(bits) < 20:
    sys.exit("the bits of Fault are not read any more")
wrong += [f"{bit} has no row" for bit in bits if f"| `{bit}` |" not in page]
stops = dict(re.findall(r"\{Fault::(k\w+), .*FaultReaction::(k\w+)\}", open("src/loop/core/fault.hpp", encoding="utf-8").read()))
for bit, reaction in stops.items():
    row = re.search(rf"^\| `{bit}` \|.*\| ([^|]*) \|$", page, re.M)
    says = row is not None and re.search(r"\bstops\b", row[1]) is not None
    if says != (reaction == "kStops"):
        wrong.append(f"{bit}: the page says {'stops' if says else 'goes on'}, the table {reaction}")
if len(stops) != len(bits):
    wrong.append(f"{len(stops)} reactions of {len(bits)} bits are read")

def exists(path, name):
    text = open(path, encoding="utf-8").read()
    if path.endswith(".py"):
        return f"def {name}(" in text
    suite, _, test = name.partition(".")
    return re.search(rf"\bTEST(_F|_P)?\(\s*{suite},\s*{test}\s*\)", text) is not None

hazards = page.split("## Hazards", 1)[1]
named = 0
for row in re.findall(r"^\|(.*)\|$", hazards, re.M)[2:]:
    hazard, _, proof = (cell.strip() for cell in row.rsplit("|", 2))
    links = re.findall(r"\[(?:`(\w+\.\w+|test_\w+)`|[^`\]]+)\]\(\.\./((?:web/)?tests/[^)]+)\)", proof)
    for name, path in links:
        if not os.path.exists(path):
            wrong.append(f"{hazard}: {path} is not there")
        elif name and not exists(path, name):
            wrong.append(f"{hazard}: {path} has no {name}")
        named += name != ""
    if re.search(r"`(\w+\.\w+|test_\w+)`(?!\]\()", proof):
        wrong.append(f"{hazard}: a test is named without its file")
    if not links:
        wrong.append(f"{hazard}: no test proves it")
if named < 30:
    wrong.append(f"only {named} tests are named")
print("\n".join(wrong) or f"{len(bits)} bits, {named} tests")
sys.exit(1 if wrong else 0)
EOF
}
judge docs/safety.md

corrupted=$(mktemp)
trap 'rm -f "$corrupted"' EXIT
# shellcheck disable=SC2016  # backquotes of Markdown
for change in 's/^| `kSpeedLimit` |.*//' '/^| `kWorkspace`/s/| stops |/| goes on |/' 's/EmergencyStop\.AtRandomTicks/EmergencyStop.AtNoTick/' \
              's/test_run_refuses_what/test_run_takes_what/' 's/crash_test\.cpp)/crashed_test.cpp)/'; do
  sed "$change" docs/safety.md > "$corrupted"
  if judge "$corrupted" > /dev/null; then
    echo "does not notice: $change"
    exit 1
  fi
done
