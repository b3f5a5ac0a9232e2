#!/usr/bin/env python3
"""The Godot addon of clients/godot: checks it, and makes what is copied into a game.

godot_addon.py make FOLDER   FOLDER/addons/wholehand, and FOLDER/wholehand-godot-<version>.zip;
                             the same for Godot 4: FOLDER/godot4/addons/wholehand, FOLDER/wholehand-godot4-<version>.zip
godot_addon.py check         the version of plugin.cfg is the project's

`make` adds protocol.gd, which it writes from protocol/wholehand.fbs, and the licence: each has one source in this
repository. Scripts for Godot 4 are translated (gdscript4.py), but for those of clients/godot/godot4."""
import argparse
import pathlib
import re
import shutil
import sys
import zipfile

import gdscript4

ROOT = pathlib.Path(__file__).resolve().parents[1]
SOURCES = ROOT / "clients/godot/addons/wholehand"
GODOT4 = ROOT / "clients/godot/godot4"  # not translated: other scripts, and README.md
DESCRIPTION_OF_GODOT4 = " Translated for Godot 4; never opened in its editor."
SCHEMA = ROOT / "protocol/wholehand.fbs"
SIZES = {"bool": 1, "byte": 1, "ubyte": 1, "short": 2, "ushort": 2, "int": 4, "uint": 4, "float": 4, "long": 8,
         "ulong": 8, "double": 8}


class Refused(Exception):
    pass


class Schema:
    """The parts of a .fbs file that are needed to read and write its messages without generated classes."""

    def __init__(self, text):
        text = re.sub(r"//[^\n]*", "", text)
        self.enums = {}    # name -> ({member: value}, size)
        self.structs = {}  # name -> ({field: offset}, size, alignment)
        self.tables = {}   # name -> {field: offset in the vtable}
        self.unions = {}   # name -> {member: value}
        for kind, name, base, body in re.findall(r"\b(enum|struct|table|union)\s+(\w+)\s*(?::\s*(\w+))?\s*\{([^}]*)\}", text):
            getattr(self, f"_add_{kind}")(name, base, body)
        if not self.tables or not self.unions:
            raise Refused(f"{SCHEMA}: no tables or no unions were found; teach scripts/godot_addon.py the new notation")

    @staticmethod
    def _members(body, first):
        value, members = first, {}
        for member in filter(None, (part.strip() for part in body.split(","))):
            name, _, given = member.partition("=")
            value = int(given) if given else value
            members[name.strip()] = value
            value += 1
        return members

    @staticmethod
    def _fields(body):
        return re.findall(r"(\w+)\s*:\s*(\[?\w+\]?)", body)

    def _add_enum(self, name, base, body):
        self.enums[name] = (self._members(body, 0), SIZES[base])

    def _add_union(self, name, _base, body):
        self.unions[name] = {"NONE": 0, **self._members(body, 1)}

    def _add_struct(self, name, _base, body):
        offset, widest, offsets = 0, 1, {}
        for field, kind in self._fields(body):
            size = self.structs[kind][1] if kind in self.structs else self.enums[kind][1] if kind in self.enums else SIZES[kind]
            alignment = self.structs[kind][2] if kind in self.structs else size
            offset += -offset % alignment
            offsets[field] = offset
            offset += size
            widest = max(widest, alignment)
        self.structs[name] = (offsets, offset + -offset % widest, widest)

    def _add_table(self, name, _base, body):
        slot, slots = 4, {}
        for field, kind in self._fields(body):
            if kind in self.unions:  # its type is in the slot before it
                slots[f"{field}_type"] = slot
                slot += 2
            slots[field] = slot
            slot += 2
        self.tables[name] = slots


def protocol_of(schema):
    def constant(name, members):
        return f"const {name} = {{" + ", ".join(f'"{key}": {value}' for key, value in members.items()) + "}\n"

    lines = ["# Written by scripts/godot_addon.py from protocol/wholehand.fbs.\nextends Reference\n\n# Enums and unions.\n"]
    lines += [constant(name, members) for name, (members, _) in schema.enums.items()]
    lines += [constant(name, members) for name, members in schema.unions.items()]
    lines.append("\n# Structs: where each field is [bytes], and the size of all.\n")
    lines += [constant(name, {**offsets, "SIZE": size}) for name, (offsets, size, _) in schema.structs.items()]
    # Tables and orders may have the name of an enum's or union's member, never of an enum.
    lines.append("\n# Tables: where each field's offset is in the vtable [bytes].\n")
    lines += [constant(name, slots) for name, slots in schema.tables.items()]
    return "".join(lines)


def project_version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"^project\(wholehand VERSION ([0-9.]+)", text, re.M).group(1)


def check(version):
    plugin = SOURCES / "plugin.cfg"
    said = re.search(r'^version="(.*)"$', plugin.read_text(encoding="utf-8"), re.M)
    if not said or said.group(1) != version:
        raise Refused(f"{plugin}: version is {said.group(1) if said else 'missing'!r}, that of the project {version!r} "
                      "(CMakeLists.txt); write the same")


def archive_of(folder, file):
    """Writes FOLDER/addons into a zip without file times, so that the same content gives the same bytes."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(p for p in (folder / "addons/wholehand").rglob("*") if p.is_file()):
            archive.writestr(zipfile.ZipInfo(path.relative_to(folder).as_posix()), path.read_bytes())
    return file


def make(folder, version):
    addon = folder / "addons/wholehand"
    shutil.rmtree(addon, ignore_errors=True)
    shutil.copytree(SOURCES, addon)
    (addon / "protocol.gd").write_text(protocol_of(Schema(SCHEMA.read_text(encoding="utf-8"))), encoding="utf-8")
    shutil.copyfile(ROOT / "LICENSE", addon / "LICENSE")
    return archive_of(folder, folder / f"wholehand-godot-{version}.zip")


def make_godot4(folder, version):
    """Translates the addon that make() has written to the same folder."""
    addon = folder / "godot4/addons/wholehand"
    shutil.rmtree(addon, ignore_errors=True)
    shutil.copytree(folder / "addons/wholehand", addon)
    found = set()
    for script in sorted(addon.glob("*.gd")):
        text, here = gdscript4.godot4_of(script.read_text(encoding="utf-8"))
        found |= here
        script.write_text(text, encoding="utf-8")
    for pattern, _ in gdscript4.rules():
        if pattern not in found:
            raise Refused(f"scripts/gdscript4.py: no script of {SOURCES} has {pattern!r}; remove the rule")
    for own in GODOT4.iterdir():
        if own.suffix == ".gd" and not (addon / own.name).exists():
            raise Refused(f"{own}: there is no {SOURCES / own.name} that it stands for; remove it, or write that one")
        shutil.copyfile(own, addon / own.name)
    plugin = addon / "plugin.cfg"
    text, times = re.subn(r'^(description=".*)"$', rf'\1{DESCRIPTION_OF_GODOT4}"', plugin.read_text(encoding="utf-8"), flags=re.M)
    if times != 1:
        raise Refused(f"{SOURCES / 'plugin.cfg'}: has no description in one line; write one")
    plugin.write_text(text, encoding="utf-8")
    return archive_of(folder / "godot4", folder / f"wholehand-godot4-{version}.zip")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("what", choices=("make", "check"))
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    arguments = parser.parse_args()
    version = project_version()
    check(version)
    if arguments.what == "make":
        if not arguments.folder:
            parser.error("make: name the folder to write to")
        print(make(arguments.folder, version))
        print(make_godot4(arguments.folder, version))


if __name__ == "__main__":
    try:
        main()
    except Refused as refused:
        sys.exit(str(refused))
