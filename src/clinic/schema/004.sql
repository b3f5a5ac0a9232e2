-- Actions over rows and files: stored with the rows' change, deleted after the last file, resumed at the next start.
CREATE TABLE intent (
  n INTEGER PRIMARY KEY AUTOINCREMENT,
  at_us INTEGER NOT NULL,
  what TEXT NOT NULL CHECK (what IN ('erase', 'delete', 'restore', 'list')),
  recordings TEXT NOT NULL,        -- JSON: names of files to remove; those of erased visits are found by number, too
  problem TEXT NOT NULL DEFAULT '' -- why it is not done yet
) STRICT;

-- What was erased, moved, joined, given and drawn here, one line each, oldest first (src/clinic/marks.hpp).
CREATE TABLE mark (
  n INTEGER PRIMARY KEY AUTOINCREMENT,
  line TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO mark (line) SELECT printf('block %s %d', id, next_visit >> 20) FROM clinic;

ALTER TABLE clinic ADD COLUMN copied_us INTEGER NOT NULL DEFAULT 0;     -- in a backup: when it was made
ALTER TABLE clinic ADD COLUMN restored TEXT NOT NULL DEFAULT '{}';      -- JSON: what a restore left to people

-- A recording of a visit that a restored backup does not know is looked at again: it may be this clinic's.
DELETE FROM trial WHERE state = 'ignored' AND visit IS NULL AND why LIKE 'visit % is not of this clinic%';

-- Numbers of notes that no page draws begin above those that pages draw, at random: no database that is restored later
-- gives the number of an erased note again.
DELETE FROM sqlite_sequence WHERE name = 'note';
INSERT INTO sqlite_sequence VALUES ('note', 281474976710656 + (abs(random()) % 1048576) * 4294967296);
