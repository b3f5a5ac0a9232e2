#!/usr/bin/env python3
"""The Unity package of clients/unity: checks it, and makes the file that Unity's package manager takes.

unity_package.py make FOLDER    FOLDER/org.wholehand.client-<version>.tgz, and what is in it unpacked beside it
unity_package.py check [PACKAGE]  the package in the sources, or an unpacked one
unity_package.py meta           writes the .meta files that the sources lack

The C# client, the generated messages, FlatBuffers' runtime and the licence are copied in by `make`: each has one source
in this repository. A GUID is derived from the file's path in the package, so that it is the same in every version;
renaming a file changes it, and breaks the scenes of games that use the file."""
import argparse
import gzip
import hashlib
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
NAME = "org.wholehand.client"
SOURCES = ROOT / "clients/unity" / NAME

IMPORTERS = {
    ".cs": "MonoImporter:\n  externalObjects: {}\n  serializedVersion: 2\n  defaultReferences: []\n  executionOrder: 0\n"
           "  icon: {instanceID: 0}\n",
    ".asmdef": "AssemblyDefinitionImporter:\n  externalObjects: {}\n",
    ".md": "TextScriptImporter:\n  externalObjects: {}\n",
    "package.json": "PackageManifestImporter:\n  externalObjects: {}\n",
    "folder": "folderAsset: yes\nDefaultImporter:\n  externalObjects: {}\n",
    "other": "DefaultImporter:\n  externalObjects: {}\n",
}
IMPORTER_END = "  userData: \n  assetBundleName: \n  assetBundleVariant: \n"


class Refused(Exception):
    pass


def guid_of(path):
    """GUID of a file. @param path in the package, with /"""
    return hashlib.md5(f"{NAME}/{path}".encode()).hexdigest()


def meta_of(package, path):
    kind = "folder" if (package / path).is_dir() else path.name if path.name in IMPORTERS else path.suffix
    return f"fileFormatVersion: 2\nguid: {guid_of(path.as_posix())}\n{IMPORTERS.get(kind, IMPORTERS['other'])}{IMPORTER_END}"


def assets_of(package):
    """Every file and folder that needs a .meta file for Unity. Unity ignores a folder whose name ends in ~, but its
    content is copied into games, with its GUIDs."""
    for path in sorted(package.rglob("*")):
        inside = path.relative_to(package)
        if path.suffix == ".meta" or any(part.startswith(".") for part in inside.parts):
            continue
        if not (path.is_dir() and path.name.endswith("~")):
            yield inside


def write_metas(package):
    written = 0
    for path in assets_of(package):
        meta = package / f"{path}.meta"
        if not meta.exists():
            meta.write_text(meta_of(package, path), encoding="utf-8")
            written += 1
    return written


def project_version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"^project\(wholehand VERSION ([0-9.]+)", text, re.M).group(1)


def faults_of(package, version):
    """Faults of the package, each as a sentence with place, problem and remedy."""
    faults = []
    remedy = "run scripts/unity_package.py meta"
    assets = list(assets_of(package))
    owners = {}
    for path in assets:
        meta = package / f"{path}.meta"
        if not meta.exists():
            faults.append(f"{package / path}: its file {meta.name} is missing, and Unity ignores what has none; {remedy}")
            continue
        guid = re.search(r"^guid: (.*)$", meta.read_text(encoding="utf-8"), re.M)
        if not guid or not re.fullmatch(r"[0-9a-f]{32}", guid.group(1)):
            faults.append(f"{meta}: guid is {guid.group(1) if guid else 'missing'!r}, not 32 hexadecimal digits; "
                          f"remove the file and {remedy}")
            continue
        first = owners.setdefault(guid.group(1), path)
        if first != path:
            faults.append(f"{meta}: guid {guid.group(1)} is that of {first}, too; remove this file and {remedy}")
        elif guid.group(1) != guid_of(path.as_posix()):
            faults.append(f"{meta}: guid {guid.group(1)} is not the one of this path, {guid_of(path.as_posix())}; "
                          f"remove the file and {remedy}")
    for meta in sorted(package.rglob("*.meta")):
        if not meta.with_suffix("").exists():
            faults.append(f"{meta}: there is no {meta.with_suffix('').name}; remove the file")
    return faults + faults_of_manifest(package, version)


def faults_of_manifest(package, version):
    path = package / "package.json"
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        return [f"{path}: {error}; a package needs a manifest in JSON"]
    faults = []
    if manifest.get("name") != NAME:
        faults.append(f"{path}: name is {manifest.get('name')!r}; write {NAME!r}")
    if manifest.get("version") != version:
        faults.append(f"{path}: version is {manifest.get('version')!r}, that of the project {version!r} (CMakeLists.txt); "
                      "write the same")
    changes = package / "CHANGELOG.md"
    if not changes.exists() or f"## [{version}]" not in changes.read_text(encoding="utf-8"):
        faults.append(f"{changes}: it has no section \"## [{version}]\"; write what is new in this version")
    for sample in manifest.get("samples", []):
        if not (package / sample["path"]).is_dir():
            faults.append(f"{path}: samples: there is no folder {sample['path']}; correct the path")
    names = {}
    for file in sorted(package.rglob("*.asmdef")):
        name = json.loads(file.read_text(encoding="utf-8"))["name"]
        if name in names:
            faults.append(f"{file}: name {name!r} is that of {names[name]}, too; rename one")
        names[name] = file
    return faults


def require(package, version):
    faults = faults_of(package, version)
    if faults:
        raise Refused("\n".join(faults))


def run(*command):
    try:
        subprocess.run([str(part) for part in command], check=True)
    except FileNotFoundError as error:
        raise Refused(f"{command[0]} is missing: scripts/packages.txt names its package") from error
    except subprocess.CalledProcessError as error:
        raise Refused(f"{pathlib.Path(command[0]).name} failed (exit code {error.returncode})") from error


def copy(files, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for file in files:
        shutil.copyfile(file, folder / file.name)


def stage(folder):
    """The whole package as a folder."""
    package = folder / NAME
    shutil.rmtree(package, ignore_errors=True)
    shutil.copytree(SOURCES, package)
    copy(sorted((ROOT / "clients/csharp/Wholehand").glob("*.cs")), package / "Runtime/Client")
    runtime = ROOT / "build/flatbuffers-csharp"
    run(ROOT / "scripts/fetch_flatbuffers_csharp.sh", runtime)
    copy(sorted(runtime.glob("*.cs")), package / "Runtime/Protocol/FlatBuffers")
    run("flatc", "--csharp", "--gen-onefile", "-o", package / "Runtime/Protocol", ROOT / "protocol/wholehand.fbs")
    shutil.copyfile(ROOT / "LICENSE", package / "LICENSE.md")
    write_metas(package)
    return package


def pack(package, file):
    """Packs like `npm pack`: everything below package/; the same content gives the same bytes."""
    plain = io.BytesIO()
    with tarfile.open(fileobj=plain, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for path in sorted(p for p in package.rglob("*") if p.is_file()):
            entry = tarfile.TarInfo(f"package/{path.relative_to(package).as_posix()}")
            entry.size, entry.mode = path.stat().st_size, 0o644
            with path.open("rb") as content:
                archive.addfile(entry, content)
    file.write_bytes(gzip.compress(plain.getvalue(), 9, mtime=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("what", choices=("make", "check", "meta"))
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    arguments = parser.parse_args()
    version = project_version()
    if arguments.what == "meta":
        print(f"{write_metas(SOURCES)} written")
        return
    if arguments.what == "check":
        require(arguments.folder or SOURCES, version)
        return
    if not arguments.folder:
        parser.error("make: name the folder to write to")
    require(SOURCES, version)  # before anything is copied over a fault
    package = stage(arguments.folder)
    require(package, version)
    file = arguments.folder / f"{NAME}-{version}.tgz"
    pack(package, file)
    print(file)


if __name__ == "__main__":
    try:
        main()
    except Refused as refused:
        sys.exit(str(refused))
