#!/usr/bin/env python3
"""Draws the rooms of src/ and the arrows between them into docs/images/rooms.svg and docs/architecture.md.

usage: draw_rooms.py            writes both
       draw_rooms.py check      exit code 1 where they are not what the sources say, or an arrow runs up

A room is a folder of src/. An arrow A -> B says that a file of A includes one of B. A room stands one floor above
the highest room that it includes.
"""
import html
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SRC = ROOT / "src"
PICTURE = ROOT / "docs/images/rooms.svg"
PAGE = ROOT / "docs/architecture.md"
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
ROOMS = {  # purpose, and centre of its box
    "driver_abi": ("what a driver in C sees", 860),
    "loop": ("one tick, and its thread", 365),
    "files": ("readers of every file", 125),
    "certify": ("gains that are proved stable", 365),
    "vocabulary": ("orders, facts, refusals", 735),
    "exercises": ("bar, kitchen, squeeze, free", 125),
    "record": ("every tick in a file", 555),
    "devices": ("drivers, host, commissioning", 860),
    "rig": ("a whole renderer, rehearsed", 365),
    "station": ("arms, stops, serves clients", 600),
    "clinic": ("patients, visits, results", 600),
    "replay": ("a recording again, bit by bit", 860),
}
WIDTH, BOX, HEIGHT, FLOOR = 980, 216, 58, 108


def measure():
    """({room: lines}, {(from, to): includes})"""
    lines, arrows = {}, {}
    for file in sorted(SRC.rglob("*")):
        if file.suffix not in (".hpp", ".cpp", ".h"):
            continue
        room = file.relative_to(SRC).parts[0]
        text = file.read_text()
        lines[room] = lines.get(room, 0) + text.count("\n")
        for header in INCLUDE.findall(text):
            target = "driver_abi" if (SRC / "driver_abi" / header).exists() else header.split("/")[0]
            if target != room and (SRC / target).is_dir() and "/" in header:
                arrows[room, target] = arrows.get((room, target), 0) + 1
    return lines, arrows


def floors_of(rooms, arrows):
    """{room: floor}, where the ground floor is 1; fails when rooms include each other in a cycle."""
    floors = {}
    while len(floors) < len(rooms):
        ready = [room for room in rooms if room not in floors
                 and all(to in floors for source, to in arrows if source == room)]
        if not ready:
            sys.exit("rooms include each other in a circle: " + ", ".join(sorted(set(rooms) - set(floors))))
        floors |= {room: 1 + max((floors[to] for source, to in arrows if source == room), default=0) for room in ready}
    return floors


def is_implied(arrows, source, target):
    """True when another path leads from source to target; such an arrow is not drawn."""
    seen, waiting = set(), [to for a, to in arrows if a == source and to != target]
    while waiting:
        room = waiting.pop()
        if room == target:
            return True
        if room not in seen:
            seen.add(room)
            waiting += [to for a, to in arrows if a == room]
    return False


def ports_of(arrows, places):
    """{arrow: (x at its source, x at its target)}; the ends at a box are side by side, ordered by the other ends."""
    ports = {arrow: [0.0, 0.0] for arrow in arrows}
    for end in (0, 1):
        for room, (x, _) in places.items():
            mine = sorted((arrow for arrow in arrows if arrow[end] == room), key=lambda arrow: places[arrow[1 - end]][0])
            for i, arrow in enumerate(mine):
                ports[arrow][end] = x + (i - (len(mine) - 1) / 2) * 40
    return ports


def picture(lines, arrows):
    floors = floors_of(lines, arrows)
    highest = max(floors.values())
    places = {room: (x, 20 + (highest - floors[room]) * FLOOR) for room, (_, x) in ROOMS.items()}
    height = 40 + (highest - 1) * FLOOR + HEIGHT
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif">',
           '<title>Rooms of src/ and who includes whom</title>',
           '<defs><marker id="end" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
           '<path d="M0 0L8 4L0 8z" fill="#5b6b7b"/></marker></defs>',
           f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>']
    shown = [arrow for arrow in sorted(arrows) if not is_implied(arrows, *arrow)]
    for (source, target), (x1, x2) in ports_of(shown, places).items():
        y1, y2 = places[source][1] + HEIGHT, places[target][1] - 1
        turn = y1 + FLOOR - HEIGHT - 1  # it bends in the gap below its source, then goes straight down
        middle = (y1 + turn) / 2
        out.append(f'<path d="M{x1:.0f} {y1}C{x1:.0f} {middle:.0f} {x2:.0f} {middle:.0f} {x2:.0f} {turn - 6}V{y2}" fill="none" '
                   'stroke="#5b6b7b" stroke-width="1.6" marker-end="url(#end)"/>')
    for room, (x, y) in places.items():
        fill, edge = ("#e3f1fb", "#1f6fb2") if room == "loop" else ("#f6f8fa", "#8a97a5")
        left, right = x - BOX / 2, x + BOX / 2
        out.append(f'<rect x="{left:.0f}" y="{y}" width="{BOX}" height="{HEIGHT}" rx="7" fill="{fill}" stroke="{edge}" stroke-width="1.5"/>'
                   f'<text x="{left + 12:.0f}" y="{y + 24}" font-size="16" font-weight="600" fill="#1b2733">{room}/</text>'
                   f'<text x="{right - 12:.0f}" y="{y + 24}" font-size="12" text-anchor="end" fill="#5b6b7b">{lines[room] / 1000:.1f}k lines</text>'
                   f'<text x="{left + 12:.0f}" y="{y + 45}" font-size="13" fill="#3a4754">{html.escape(ROOMS[room][0])}</text>')
    return "\n".join([*out, "</svg>", ""])


def sentence(lines, arrows):
    floors = floors_of(lines, arrows)
    return (f"<!-- rooms: written by scripts/draw_rooms.py -->\n"
            f"{len(lines)} rooms on {max(floors.values())} floors, {len(arrows)} arrows between them, none up. "
            f"The picture leaves out arrows that follow from others.\n"
            f"<!-- end of rooms -->")


def main():
    lines, arrows = measure()
    unknown = set(lines) ^ set(ROOMS)
    if unknown:
        sys.exit(f"scripts/draw_rooms.py says nothing of: {', '.join(sorted(unknown))}")
    drawn = picture({room: round(count, -2) for room, count in lines.items()}, arrows)
    page = re.sub(r"<!-- rooms:.*?<!-- end of rooms -->", lambda _: sentence(lines, arrows), PAGE.read_text(), flags=re.DOTALL)
    if sys.argv[1:] == ["check"]:
        # The number of lines changes daily; only the includes must agree.
        strip = lambda text: re.sub(r"[\d.]+k lines", "", text)  # noqa: E731
        if not PICTURE.exists() or strip(PICTURE.read_text()) != strip(drawn) or page != PAGE.read_text():
            sys.exit("docs/images/rooms.svg or docs/architecture.md is not what the sources say; run scripts/draw_rooms.py")
    elif sys.argv[1:]:
        sys.exit(__doc__)
    else:
        PICTURE.write_text(drawn)
        PAGE.write_text(page)
    print(sentence(lines, arrows).splitlines()[1])
    return 0


if __name__ == "__main__":
    sys.exit(main())
