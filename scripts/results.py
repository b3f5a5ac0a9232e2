#!/usr/bin/env python3
"""Measures what docs/results.toml lists, and writes docs/results.json and the pages made of it.

usage: results.py measure [NAME ...]   runs the commands (all, or those named) and writes the pages
       results.py pictures [NAME ...]  runs what a picture of docs/images needs, and draws its page
       results.py write                writes docs/results.md and README.md's table from results.json
       results.py check                exit code 1 where a page says another thing than results.json

Commands are run from the repository's folder. They print lines "figure: <name> = <value> <unit>", or
write a JSON file ({json} in the command) of which results.toml picks values.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIST, DATA, PAGE = (ROOT / "docs" / name for name in ("results.toml", "results.json", "results.md"))
README = ROOT / "README.md"
BEGIN, END = "<!-- figures: written by scripts/results.py -->\n", "<!-- end of figures -->\n"
MOST = 8
FIGURE = re.compile(r"^figure: (.+?) = (.+?)\s*$", re.MULTILINE)


def first_line(path, pattern):
    match = re.search(pattern, Path(path).read_text(encoding="utf-8"), re.MULTILINE)
    return match.group(1).strip() if match else "unknown"


def describe_machine():
    processor = first_line("/proc/cpuinfo", r"^model name\s*:(.*)$")
    memory_gb = int(first_line("/proc/meminfo", r"^MemTotal:\s*(\d+)")) / 1e6
    kernel = os.uname().release.split("-")[0]
    return f"{processor}, {os.cpu_count()} cores, {memory_gb:.0f} GB, Linux {kernel}"


def pick(data, path):
    """The value at "tuned.0.slip_mm"; "max(trials.slip_mm)", "min(...)" and "count(...)" cover a list."""
    over = re.fullmatch(r"(max|min|count)\((.*?)\.([^.]+)\)", path)
    if over:
        rows = [row[over.group(3)] for row in pick(data, over.group(2))]
        return {"max": max, "min": min, "count": sum}[over.group(1)](rows)
    for part in path.split("."):
        data = data[int(part)] if isinstance(data, list) else data[part]
    return data


def measure(entry):
    """Figures of one command, with the date and the machine's load."""
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory(prefix="wholehand-results-") as folder:
        file = Path(folder) / "figures.json"
        command = [word.format(json=file, out=folder) for word in shlex.split(entry["run"])]
        began = time.monotonic()
        environment = dict(os.environ, **entry.get("environment", {}))
        done = subprocess.run(command, cwd=ROOT, env=environment, text=True, capture_output=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{entry['run']}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        figures = [list(found) for found in FIGURE.findall(done.stdout)]
        if "pick" in entry:
            data = json.loads(file.read_text(encoding="utf-8"))
            for name, (path, scale, unit) in entry["pick"].items():
                figures.append([name, f"{scale * pick(data, path):.4g} {unit}".strip()])
    if not figures:
        sys.exit(f"{entry['run']}: printed no figure")
    return {"run": entry["run"], "environment": entry.get("environment", {}), "figures": figures,
            "date": time.strftime("%Y-%m-%d", time.gmtime()), "load": round(load, 1),
            "took_s": round(time.monotonic() - began)}


def measure_all(names):
    listed = tomllib.loads(LIST.read_text(encoding="utf-8"))
    unknown = set(names) - set(listed["measure"])
    if unknown:
        sys.exit(f"{LIST.name} lists no {', '.join(sorted(unknown))}; it lists {', '.join(listed['measure'])}")
    for name, entry in listed["measure"].items():
        if names and name not in names:
            continue
        print(f"{name}: {entry['run']} ...", flush=True)
        measured = measure(entry)
        # Read again, because another process may have measured meanwhile.
        data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {"measured": {}}
        data["measured"][name] = measured
        data["machine"] = describe_machine()
        data["version"] = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, text=True,
                                         capture_output=True, check=False).stdout.strip()
        DATA.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"  {len(data['measured'][name]['figures'])} figures in {data['measured'][name]['took_s']} s")


def draw_pictures(names):
    """Runs a command that writes a picture, or a page of charts that a headless browser turns into a picture."""
    listed = tomllib.loads(LIST.read_text(encoding="utf-8"))["picture"]
    unknown = set(names) - set(listed)
    if unknown:
        sys.exit(f"{LIST.name} lists no picture {', '.join(sorted(unknown))}; it lists {', '.join(listed)}")
    for name in names or listed:
        with tempfile.TemporaryDirectory(prefix="wholehand-pictures-") as folder:
            page = Path(folder) / "page.html"
            command = [word.format(page=page, out=folder) for word in shlex.split(listed[name]["run"])]
            print(f"{name}: {listed[name]['run']} ...", flush=True)
            subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
            if "file" in listed[name]:
                shutil.copyfile(Path(folder) / listed[name]["file"], ROOT / f"docs/images/{name}.png")
                continue
            shot = f"{name}={page.as_uri()}?lang=en&theme=light state:shown only:.paper"
            subprocess.run(["node", "tools/shot.mjs", str(ROOT / "docs/images"), shot], cwd=ROOT / "web", check=True,
                           env=dict(os.environ, SCALE="1.5", SETTLE="0"))


def command_of(measured):
    environment = " ".join(f"{key}={value}" for key, value in measured["environment"].items())
    words = measured["run"].replace("{json}", "F.json").replace("{out}", "DIR")
    return f"{environment} {words}".strip()


def figure_lines(figures):
    """One line per figure. Figures whose names are equal, or equal up to the last comma or "at", share a line in their
    order; for more than MOST figures of one unit, it gives the smallest and the largest."""
    groups = {}
    for what, value in figures:
        head, _, rest = re.fullmatch(r"(.*?)(?:(, | at )((?:(?!, | at ).)*))?", what).groups("")
        groups.setdefault(head, []).append((what, rest, *value.partition(" ")[::2]))
    lines = []
    for head, group in groups.items():
        if len({what for what, *_ in group}) == 1:
            head, group = group[0][0], [(what, "", number, unit) for what, _, number, unit in group]
        units = {unit for *_, unit in group}
        alike = len(units) == 1 and len(group) > 1 and not any(unit == "" or unit.startswith("of ") for unit in units)
        shared = f" [{units.pop()}]" if alike else ""
        if len(group) > MOST and (shared or units == {""}):
            group.sort(key=lambda of: abs(float(of[2])))
            group = [(what, f"{which} of {len(group)}, {rest}".rstrip(", ") + ":", number, unit)
                     for which, (what, rest, number, unit) in zip(("least", "most"), (group[0], group[-1]))]
        lines.append(f"- {head}{shared}: " + "; ".join(
            " ".join(filter(None, (rest, number, "" if shared else unit))) for _, rest, number, unit in group))
    return lines


def page(listed, data):
    lines = ["# Results", "",
             "Written by `scripts/results.py measure` from what the commands printed; not by hand. "
             f"Machine: {data['machine']}, a virtual machine without a real-time kernel. "
             "*Load*: processes that ran when the command began. Times by the clock depend on it; "
             "everything on the simulated clock does not.", ""]
    for name, entry in listed["measure"].items():
        measured = data["measured"].get(name)
        if measured is None:
            continue
        lines += [f"## {entry['about']}", "",
                  f"`{command_of(measured)}`, {measured['date']}, load {measured['load']}", "",
                  *figure_lines([f for f in measured["figures"] if not re.match(entry.get("left_out", "(?!)"), f[0])]), ""]
    return "\n".join(lines)


def headline(listed, data):
    """README's table with the main results, taken from the same figures."""
    lines = ["| what | asked | measured |", "|---|---|---|"]
    for row in listed["headline"]:
        measured = data["measured"].get(row["of"])
        if measured is None:
            sys.exit(f"results.json has no {row['of']} yet; run: scripts/results.py measure {row['of']}")
        figures = dict(measured["figures"])
        missing = [name for name in row["figures"] if name not in figures]
        if missing:
            sys.exit(f"{LIST.name}: headline \"{row['what']}\": {row['of']} printed no \"{missing[0]}\"")
        said = row.get("said", "{}").format(*(figures[name] for name in row["figures"]))
        lines.append(f"| {row['what']} | {row['asked']} | {said} |")
    return "\n".join(lines) + "\n"


def pages():
    """{file: text} of the pages made from results.json."""
    listed, data = tomllib.loads(LIST.read_text(encoding="utf-8")), json.loads(DATA.read_text(encoding="utf-8"))
    readme = README.read_text(encoding="utf-8")
    if BEGIN not in readme or END not in readme:
        sys.exit(f"README.md has no place for the figures: {BEGIN.strip()} ... {END.strip()}")
    before, rest = readme.split(BEGIN)
    return {PAGE: page(listed, data), README: before + BEGIN + headline(listed, data) + END + rest.split(END)[1]}


def main():
    what, names = (sys.argv[1:2] or [""])[0], sys.argv[2:]
    if what not in ("measure", "pictures", "write", "check") or (names and what not in ("measure", "pictures")):
        sys.exit(__doc__)
    if what == "pictures":
        return draw_pictures(names)
    if what == "measure":
        measure_all(names)
    different = [file for file, text in pages().items()
                 if not file.exists() or file.read_text(encoding="utf-8") != text]
    if what == "check":
        for file in different:
            print(f"{file.relative_to(ROOT)} does not say what docs/results.json says; run: scripts/results.py write")
        sys.exit(1 if different else 0)
    for file in different:
        file.write_text(pages()[file], encoding="utf-8")


if __name__ == "__main__":
    main()
