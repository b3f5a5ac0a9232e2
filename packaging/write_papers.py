#!/usr/bin/env python3
"""Writes what goes with the Debian packages: man pages, manuals, their changelog, a bill of materials.

usage: write_papers.py BUILD_FOLDER      into BUILD_FOLDER/papers

Man pages come from the program's own --help (help2man). The bill of materials is SPDX 2.3: the Debian
packages that the program was built with, as dpkg knows them, and the npm packages of web/package-lock.json
that are in the built pages. The date is that of the newest commit, or of CHANGELOG.md where there is none:
the same sources give the same files.
"""
import gzip
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from datetime import datetime, timezone
from email.utils import format_datetime
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MAINTAINER = re.search(r'PACKAGE_MAINTAINER "(.*)" CACHE', (ROOT / "packaging/CMakeLists.txt").read_text())[1]


def printed_by(*command, **more):
    return subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT, **more).stdout


def write_gzip(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def date_of_sources():
    said = subprocess.run(["git", "-c", f"safe.directory={ROOT}", "log", "-1", "--format=%ct"],
                          capture_output=True, text=True, cwd=ROOT)
    is_known = said.returncode == 0 and said.stdout.strip() != ""
    seconds = int(said.stdout) if is_known else int((ROOT / "CHANGELOG.md").stat().st_mtime)
    return datetime.fromtimestamp(seconds, timezone.utc)


def subcommands_of(help_text):
    """[(name, what it does)] of the list that --help ends with."""
    listed = help_text.partition("\nSubcommands:\n")[2]
    return re.findall(r"^  ([a-z-]+) +(.+)$", listed, re.MULTILINE)


def write_man_pages(program, folder, version, date):
    """One page for the program, one for each of its subcommands: wholehand-device-commission.1."""
    environment = {**os.environ, "SOURCE_DATE_EPOCH": str(int(date.timestamp())), "LC_ALL": "C.UTF-8"}

    def write(words, what):
        command = " ".join([str(program), *words])
        name = "-".join(["wholehand", *words])
        page = printed_by("help2man", "--no-info", "--section=1", f"--name={what}", f"--version-string={version}",
                          command, env=environment)
        page = page.replace(f"wholehand {' '.join(words)} \\-", f"{name} \\-", 1)
        page = re.sub(r'^\.TH .*? "?1"? ', f'.TH {name.upper()} "1" ', page, count=1, flags=re.MULTILINE)
        write_gzip(folder / f"{name}.1.gz", page)
        inner = subcommands_of(printed_by(program, *words, "--help"))
        for subcommand, described in inner:
            write([*words, subcommand], described.strip().rstrip("?."))

    write([], "whole-hand haptic rendering for hand rehabilitation")


def write_clinic_page(program, folder, version, date):
    environment = {**os.environ, "SOURCE_DATE_EPOCH": str(int(date.timestamp())), "LC_ALL": "C.UTF-8"}
    page = printed_by("help2man", "--no-info", "--section=1", "--name=keeps a clinic's patients, visits and results",
                      f"--version-string={version}", str(program), env=environment)
    write_gzip(folder / "wholehand-clinic.1.gz", page)


def names_in(section):
    """Package names of a section of scripts/packages.txt."""
    part = (ROOT / "scripts/packages.txt").read_text().partition(f"[{section}]")[2].partition("\n[")[0]
    return [line.split()[0] for line in part.splitlines()[1:] if line.strip() and not line.startswith("#")]


def debian_parts():
    said = printed_by("dpkg-query", "-W", "-f=${Package}\t${Version}\t${Homepage}\n", *names_in("run"))
    return [(name, version, f"pkg:deb/debian/{name}@{version}") for name, version, _ in
            (line.split("\t") for line in said.splitlines())]


def npm_parts():
    lock = json.loads((ROOT / "web/package-lock.json").read_text())["packages"]
    found = []
    for path, entry in lock.items():
        if path.startswith("node_modules/") and not entry.get("dev"):
            name = path.rpartition("node_modules/")[2]
            found.append((name, entry["version"], f"pkg:npm/{name.replace('@', '%40')}@{entry['version']}"))
    return found


def bill_of_materials(version, date):
    def package(identifier, name, its_version, locator=None):
        entry = {"SPDXID": identifier, "name": name, "versionInfo": its_version, "downloadLocation": "NOASSERTION",
                 "filesAnalyzed": False, "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION",
                 "copyrightText": "NOASSERTION"}
        if locator:
            entry["externalRefs"] = [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                      "referenceLocator": locator}]
        return entry

    packages = [package("SPDXRef-wholehand", "wholehand", version)]
    packages[0]["licenseDeclared"] = "Apache-2.0"
    relations = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                  "relatedSpdxElement": "SPDXRef-wholehand"}]
    for kind, parts, relation in (("deb", debian_parts(), "BUILD_DEPENDENCY_OF"), ("npm", npm_parts(), "CONTAINS")):
        for name, its_version, locator in parts:
            identifier = f"SPDXRef-{kind}-{re.sub('[^A-Za-z0-9.-]', '-', name)}"
            packages.append(package(identifier, name, its_version, locator))
            ends = (identifier, "SPDXRef-wholehand") if kind == "deb" else ("SPDXRef-wholehand", identifier)
            relations.append({"spdxElementId": ends[0], "relationshipType": relation, "relatedSpdxElement": ends[1]})
    digest = hashlib.sha256(json.dumps(packages, sort_keys=True).encode()).hexdigest()
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
            "name": f"wholehand-{version}", "documentNamespace": f"urn:sha256:{digest}",
            "creationInfo": {"created": date.strftime("%Y-%m-%dT%H:%M:%SZ"),
                             "creators": ["Tool: wholehand-packaging/write_papers.py"]},
            "packages": packages, "relationships": relations}


# Files of the sources in share/doc/wholehand, in the same places. examples/ is added by include/CMakeLists.txt.
MANUALS = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "THIRD_PARTY.md", "docs", "clients/csharp", "clients/godot",
           "clients/unity", "clients/python/README.md", "clients/python/examples", "lab/train_a_reach.py",
           "protocol/wholehand.fbs", "scripts/fetch_flatbuffers_csharp.sh", "src/driver_abi/wholehand/device.h",
           "src/certify/passivity.hpp", "src/loop/control/viscoelastic.hpp", "src/replay/replay_question.hpp",
           "tests/devices/faulty_driver.c"]
ELSEWHERE = {"config": "../../wholehand/config", "data": "../../wholehand/data"}  # from share/doc/wholehand
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s#]*)(#[^)\s]*)?\)")


def write_manuals(folder):
    """Copies MANUALS; links lead to what is installed, and others become text."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in MANUALS:
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, place, ignore=shutil.ignore_patterns("__pycache__", "results.*ml", "results.json"))
        else:
            shutil.copy(ROOT / name, place)
    there = {str(path.relative_to(folder)) for path in folder.rglob("*")}
    there |= {str(path.relative_to(ROOT)) for path in [ROOT / "examples", *(ROOT / "examples").rglob("*")]}

    def installed(page, link):
        mark, text, target, part = link.group(1), link.group(2), link.group(3), link.group(4) or ""
        if not target or ":" in target:
            return link.group(0)
        name = os.path.normpath(page.parent / target)
        top, _, rest = name.partition("/")
        if name in there:
            return link.group(0)
        if top in ELSEWHERE:
            return f"{mark}[{text}]({os.path.relpath(os.path.join(ELSEWHERE[top], rest), page.parent)}{part})"
        return text

    for path in folder.rglob("*.md"):
        page = path.relative_to(folder)
        path.write_text(LINK.sub(lambda link, page=page: installed(page, link), path.read_text(encoding="utf-8")),
                        encoding="utf-8")


def main():
    build = Path(sys.argv[1]).resolve()
    papers = build / "papers"
    program = build / "wholehand"
    version = printed_by(program, "--version").split()[1]
    date = date_of_sources()
    write_man_pages(program, papers / "man", version, date)
    write_clinic_page(build / "wholehand-clinic", papers / "man-clinic", version, date)
    write_manuals(papers / "manuals")
    write_gzip(papers / "changelog.gz", f"wholehand ({version}) unstable; urgency=medium\n\n"
               "  * Built from the sources; what changed is in their CHANGELOG.md.\n\n"
               f" -- {MAINTAINER}  {format_datetime(date)}\n")
    (papers / "sbom.spdx.json").write_text(json.dumps(bill_of_materials(version, date), indent=1) + "\n")


if __name__ == "__main__":
    main()
