#!/usr/bin/env python3
"""Holds every #include of the repository against scripts/include_rules.toml.

usage: check_includes.py [ROOT]      exit code 0: all well, 1: faults, one a line on stderr
"""
import re
import sys
import tomllib
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/', re.DOTALL)


class Rules:
    def __init__(self, file):
        table = tomllib.loads(file.read_text())
        self.generated = table["generated"]
        self.roots = table["roots"]
        self.folders = table["folders"]
        self.modules = table["modules"]
        self.vendors = table["vendors"]
        self.system = table["system"]
        self.words = table["words"]

    def module_of(self, path):
        """The module that a path relative to src/ belongs to, or None."""
        parts = path.split("/")[:-1]
        for length in range(len(parts), 0, -1):
            name = "/".join(parts[:length])
            if name in self.modules:
                return name
        return None

    def from_src(self, root, header):
        """A header's path relative to src/; includes of a module in `roots` are relative to its folder."""
        return next((f"{folder}/{header}" for folder in self.roots if (root / "src" / folder / header).exists()), header)

    def allows(self, module, header):
        """True when a module may include this header of the project, given relative to src/."""
        target = self.module_of(header)
        return target == module or any(self.names(name, target) for name in self.modules[module])

    @staticmethod
    def names(listed, module):
        """True when a list entry names this module or, with a slash at its end, the module's room."""
        return module == listed or listed.endswith("/") and f"{module}/".startswith(listed)

    def fault_of_vendor(self, module, header):
        for prefix, allowed in self.vendors.items():
            if header.startswith(prefix):
                return None if module in allowed else f"only {', '.join(allowed)} may include <{header}>"
        for prefix in self.system["forbidden"]:
            same = header.startswith(prefix) if prefix.endswith("/") else header == prefix
            if same and module in self.system["pure"]:
                return f"{module} knows no clock, thread or I/O, but includes <{header}>"
        return None


def faults_of_file(rules, root, file, module):
    text = file.read_text()
    code = COMMENT.sub(lambda m: "\n" * m.group().count("\n"), text)
    for match in INCLUDE.finditer(code):
        line = code.count("\n", 0, match.start(2)) + 1
        where = f"{file.relative_to(root)}:{line}"
        header = rules.from_src(root, match[2])
        if header in rules.generated:
            fault = None
        elif header != match[2]:
            fault = None if rules.allows(module, header) else f"{module} must not include {match[2]}"
        elif match[1] == "<":
            fault = rules.fault_of_vendor(module, header)
        elif (root / "src" / header).exists():
            fault = None
            if rules.module_of(header) is None:
                fault = f"{header} is in no module of scripts/include_rules.toml"
            elif not rules.allows(module, header):
                fault = f"{module} must not include {header}"
        elif header.split("/")[0] in rules.folders and (root / header).exists():
            folder = header.split("/")[0]
            own = folder == module or folder in rules.modules[module]
            fault = None if own else f"{module} must not include {header}"
        elif (file.parent / header).exists() and "/" not in header and module in rules.folders:
            fault = None  # apps and include: a header in the same folder
        elif (root / "include" / header).exists():
            fault = None if "include" in rules.modules[module] else f"{module} must not include {header}"
        else:
            fault = f'"{header}" is no file of ours; write "module/file.hpp", vendors in <>'
        if fault:
            yield f"{where}: {fault}"
    for word in rules.words.get(module, []):
        match = re.search(rf"\b{word}\b", code)
        if match:
            line = code.count("\n", 0, match.start()) + 1
            yield f"{file.relative_to(root)}:{line}: {module} has no '{word}'"


def faults_of_table(rules):
    """Checks that every name in a list is a module listed earlier, so that there are no include cycles."""
    order = list(rules.modules)
    for module, allowed in rules.modules.items():
        for name in allowed:
            targets = [other for other in order if rules.names(name, other)]
            if not targets or any(order.index(other) >= order.index(module) for other in targets):
                yield f"scripts/include_rules.toml: {module} lists {name}, which is no module above it"


def faults_of_installation(root):
    """Headers that an installed header includes must also be installed: include/CMakeLists.txt."""
    listing = root / "include" / "CMakeLists.txt"
    if not listing.exists():
        return
    installed = set(re.findall(r"[\w/]+\.hpp", listing.read_text()))
    headers = [f for name in sorted(installed) if (f := root / "src" / name).exists()]
    for file in headers + sources(root / "include"):
        for match in INCLUDE.finditer(COMMENT.sub("", file.read_text())):
            if match[1] == '"' and (root / "src" / match[2]).exists() and match[2] not in installed:
                yield (f"{file.relative_to(root)}: includes {match[2]}, which is not installed; "
                       "name it in include/CMakeLists.txt")


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".hpp", ".cpp", ".h", ".cc")
                  and "tests" not in p.relative_to(folder).parts)


def check(root, rules):
    faults = []
    count = 0
    files = [(f, rules.module_of(str(f.relative_to(root / "src")))) for f in sources(root / "src")]
    for module, folder in rules.folders.items():
        files += [(f, module) for f in sources(root / folder)]
    for file, module in files:
        count += 1
        if module is None:
            faults.append(f"{file.relative_to(root)}: its folder is not in scripts/include_rules.toml")
        else:
            faults += faults_of_file(rules, root, file, module)
    faults += faults_of_table(rules)
    faults += faults_of_installation(root)
    return count, faults


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    rules = Rules(Path(__file__).parent / "include_rules.toml")
    count, faults = check(root, rules)
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f"{count} files, {len(faults)} faults")
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
