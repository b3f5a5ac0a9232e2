"""Finds identifiers that were given up for plainer ones, and commit subjects that are not plain."""
import re
import subprocess
import sys
from pathlib import Path

FOLDERS = ("src", "apps", "drivers", "experiments", "lab", "include", "examples", "tests", "web/src")
ENDINGS = {".cpp", ".hpp", ".ts"}
GIVEN_UP = """
    ControlsArbiter ControlDesk Endings refuseUnseen countOn Asker Giver PoolFilling pocketAt mostOfPeriod LetGoProof
    Clearance clearToArm BodyStory TouchLog PartLog ClientLine SilentLine WebSocketLine kUnsaid Unsaid
    layDownWhatStands uncaughtOpening callOffAlarm atItsMark goneFromBackups_us whyForeign leaveAlone noteJoined
    EXPECT_SAYS kFew kCountsTell aTenth allOrOne Sinner Telling Startled Awkward Bedside
    judgeReading judgeWorld judgeWrite judgeStep tellStep tellMotion
""".split()
TYPES = "Seen Kept Said Told Found Given Taken Held Wanted Answered Cleared Wrong What Asker".split()
FUNCTIONS = "see obey hear".split()
FORBIDDEN = re.compile(
    rf"\b(?:{'|'.join(GIVEN_UP)})\b"
    rf"|\b(?:class|struct|enum|interface|typename|type)\s+(?:{'|'.join(TYPES)})\b"
    rf"|(?<![\w-])(?:{'|'.join(FUNCTIONS)})\(")
# Comments and texts are for people, not identifiers.
LITERAL = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|`(?:\\.|[^`\\])*`', re.DOTALL)
# Names that programs outside of this repository use go on being understood.
ALIAS = re.compile(r"^using (ControlsArbiter|Clearance) = \w+;", re.MULTILINE)

BASE = "bf19dc6c42cee3ad028ee6f52f1b6a88dc80c82c"  # the rule holds for the commits after this one
LONGEST = 72
NO_VERBS = set("""
    A An The Of In On At By For From With Without As All Any Every Each No None Not Nothing New Old One Two What Who Why
    When Where Which Whose How Names Words Word Tests Test Files File More Less Most Last First Likewise So Also It
    Its This That These Those There Here And Or But If Is Are Was Were Has Have Had
""".split())
VERBS_IN_ED_OR_ING = {"Bring", "Embed", "Feed", "Need", "Ping", "Seed", "Shed", "Speed", "String", "Swing"}
MACHINE = re.compile(r"(?<![\w.])/(?:tmp|work|home|root)\b")


def faults_of_names(root):
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in ENDINGS or {"generated", "node_modules"} & set(file.parts):
                continue
            text = file.read_text(encoding="utf-8")
            code = LITERAL.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)
            if folder == "include":
                code = ALIAS.sub(lambda m: " " * len(m[0]), code)
            for found in FORBIDDEN.finditer(code):
                line = code.count("\n", 0, found.start()) + 1
                yield f"{file.relative_to(root)}:{line}: {found[0]} is not a plain name"


def fault_of_subject(subject):
    """Why a commit's subject is refused; empty: it is not."""
    first = subject.split(" ")[0].rstrip(":,")
    if len(subject) > LONGEST:
        return f"has {len(subject)} characters, more than {LONGEST}"
    past = first.endswith(("ed", "ing")) and first not in VERBS_IN_ED_OR_ING
    if not re.fullmatch(r"[A-Z][a-z]+(?:-[a-z]+)?", first) or first in NO_VERBS or past:
        return "does not begin with a capitalised imperative verb"
    if ";" in subject:
        return "names two changes"
    if MACHINE.search(subject):
        return "names a path of one machine"
    return ""


def faults_of_subjects(root):
    git = ["git", "-c", f"safe.directory={root}", "-C", str(root)]
    try:
        log = subprocess.run([*git, "log", f"{BASE}..HEAD", "--no-merges", "--format=%h %s"],
                             capture_output=True, text=True)
    except FileNotFoundError:
        return
    if log.returncode != 0:  # no repository, or one without that commit
        return
    for line in log.stdout.splitlines():
        commit, _, subject = line.partition(" ")
        if why := fault_of_subject(subject):
            yield f"commit {commit} {why}: {subject}"


# Subjects that hold, and one for every fault.
GOOD = ["Rename ControlsArbiter to ControlHolder", "Bring the axes home", "Need a passport", "Feed the watchdog"]
BAD = ["Renamed a class", "Renaming a class", "The class has another name", "rename a class", "Rename; move",
       "Read /tmp/a", "Rename " + 66 * "a"]


def main():
    for subject in GOOD:
        assert not fault_of_subject(subject), subject
    for subject in BAD:
        assert fault_of_subject(subject), subject
    root = Path(__file__).resolve().parents[2]
    faults = [*faults_of_names(root), *faults_of_subjects(root)]
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
