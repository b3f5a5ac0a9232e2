-- Times: microseconds UTC. Columns named secret, name, pin, text, body: sealed under the clinic's key.
CREATE TABLE clinic (
  one INTEGER PRIMARY KEY CHECK (one = 1),
  id TEXT NOT NULL,                -- random; the file `keys` names it
  next_visit INTEGER NOT NULL      -- in a block drawn at random, so that numbers of two clinics differ
) STRICT;

CREATE TABLE account (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name BLOB NOT NULL,
  colour TEXT NOT NULL,
  pin BLOB NOT NULL,
  failed INTEGER NOT NULL DEFAULT 0   -- wrong PINs since the last right one
) STRICT;

CREATE TABLE patient (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  mark TEXT NOT NULL UNIQUE,       -- random; stands in the list `erased`
  version INTEGER NOT NULL,
  code TEXT NOT NULL COLLATE NOCASE UNIQUE,
  side TEXT NOT NULL CHECK (side IN ('right', 'left', 'both')),
  hands TEXT NOT NULL,             -- JSON
  preset TEXT NOT NULL,
  parameters TEXT NOT NULL,        -- JSON
  plan TEXT NOT NULL,              -- JSON
  plan_us INTEGER NOT NULL,        -- when the plan was last changed
  created_us INTEGER NOT NULL,
  secret BLOB NOT NULL             -- JSON: name, born, number, warnings
) STRICT;

CREATE TABLE visit (
  id INTEGER PRIMARY KEY,
  patient INTEGER REFERENCES patient (id),   -- NULL: a guest
  account INTEGER NOT NULL REFERENCES account (id),
  side TEXT NOT NULL,
  hand TEXT NOT NULL,              -- a shipped hand; empty: hand_file
  hand_file TEXT NOT NULL,
  began_us INTEGER NOT NULL,
  ended_us INTEGER NOT NULL,       -- 0: not yet
  offset_min INTEGER NOT NULL,     -- local time minus UTC when it began
  state TEXT NOT NULL CHECK (state IN ('open', 'unfinished', 'done', 'no_show', 'guest')),
  plan TEXT NOT NULL,              -- JSON
  item INTEGER NOT NULL,           -- in progress
  pain_before INTEGER,
  pain_after INTEGER
) STRICT;
CREATE INDEX visit_of_patient ON visit (patient, began_us);
CREATE INDEX visit_by_state ON visit (state) WHERE state IN ('open', 'unfinished', 'guest');

-- An index of the recordings, which are the truth.
CREATE TABLE trial (
  id INTEGER PRIMARY KEY,
  recording TEXT NOT NULL UNIQUE,  -- file name
  size INTEGER NOT NULL,
  modified_ns INTEGER NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('waiting', 'measured', 'failed', 'ignored')),
  why TEXT NOT NULL,
  visit INTEGER REFERENCES visit (id) ON DELETE CASCADE,
  item INTEGER NOT NULL,
  began_us INTEGER NOT NULL,
  sha256 TEXT NOT NULL,
  measures_version INTEGER NOT NULL,
  measures TEXT NOT NULL           -- JSON, as `wholehand measures` said it
) STRICT;
CREATE INDEX trial_of_visit ON trial (visit);

CREATE TABLE note (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  patient INTEGER REFERENCES patient (id) ON DELETE CASCADE,
  visit INTEGER REFERENCES visit (id) ON DELETE CASCADE,
  account INTEGER NOT NULL REFERENCES account (id),
  at_us INTEGER NOT NULL,
  kind TEXT NOT NULL,
  text BLOB NOT NULL
) STRICT;
CREATE INDEX note_of_visit ON note (visit);
CREATE INDEX note_of_patient ON note (patient);

-- Answers by the page's own request number: sent again, a request changes nothing twice.
CREATE TABLE answer (
  key TEXT PRIMARY KEY,            -- digest
  request TEXT NOT NULL,           -- digest
  at_us INTEGER NOT NULL,
  body BLOB NOT NULL
) STRICT;

CREATE TABLE log (
  n INTEGER PRIMARY KEY AUTOINCREMENT,
  at_us INTEGER NOT NULL,
  account INTEGER NOT NULL,        -- 0: the process itself
  what TEXT NOT NULL,
  patient INTEGER NOT NULL,        -- 0: none
  visit INTEGER NOT NULL,          -- 0: none
  detail TEXT NOT NULL             -- never a name
) STRICT;
CREATE TRIGGER log_is_not_changed BEFORE UPDATE ON log
BEGIN SELECT RAISE(ABORT, 'the log only grows'); END;
CREATE TRIGGER log_is_not_deleted BEFORE DELETE ON log
BEGIN SELECT RAISE(ABORT, 'the log only grows'); END;
