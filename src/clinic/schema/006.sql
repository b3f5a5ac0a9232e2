-- Every row carries the number of the change that wrote it, and a keyed digest (src/clinic/row_digests.hpp).
ALTER TABLE clinic ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE clinic ADD COLUMN row_digest BLOB;
ALTER TABLE account ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE account ADD COLUMN row_digest BLOB;
ALTER TABLE patient ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE patient ADD COLUMN row_digest BLOB;
ALTER TABLE visit ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE visit ADD COLUMN row_digest BLOB;
ALTER TABLE trial ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE trial ADD COLUMN row_digest BLOB;
ALTER TABLE note ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE note ADD COLUMN row_digest BLOB;
ALTER TABLE answer ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE answer ADD COLUMN row_digest BLOB;
ALTER TABLE log ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE log ADD COLUMN row_digest BLOB;
ALTER TABLE merged ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE merged ADD COLUMN row_digest BLOB;
ALTER TABLE intent ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE intent ADD COLUMN row_digest BLOB;
ALTER TABLE mark ADD COLUMN row_n INTEGER NOT NULL DEFAULT 0;
ALTER TABLE mark ADD COLUMN row_digest BLOB;

-- `changes`: changes of rows until now, which orders events; `lost`: changes that a damaged write-ahead log lost, until
-- somebody confirms it; `jump`: when the clock jumped, until somebody confirms it, else 0; the names of tables: the last
-- number that each has given.
CREATE TABLE counter (
  name TEXT NOT NULL UNIQUE,
  n INTEGER NOT NULL,
  row_n INTEGER NOT NULL DEFAULT 0,
  row_digest BLOB
) STRICT;

-- The digest is set after the row is written.
DROP TRIGGER log_is_not_changed;
CREATE TRIGGER log_is_not_changed BEFORE UPDATE OF n, at_us, account, what, patient, visit, detail ON log
BEGIN SELECT RAISE(ABORT, 'the log only grows'); END;

-- The count of changes orders what happened: a clock may be set back. Earlier rows come before, by their time.
ALTER TABLE visit ADD COLUMN began_n INTEGER NOT NULL DEFAULT 0;
UPDATE visit SET began_n = began_us - 4000000000000000;
ALTER TABLE patient ADD COLUMN plan_n INTEGER NOT NULL DEFAULT 0;
UPDATE patient SET plan_n = plan_us - 4000000000000000;
ALTER TABLE patient DROP COLUMN plan_us;

-- A stored answer is repeated only to a session that sees as much: names were shown (1) or hidden (0).
ALTER TABLE answer ADD COLUMN shown INTEGER NOT NULL DEFAULT 1;

-- A wait after wrong PINs survives a restart. Account 0: the pass phrase and the recovery code.
CREATE TABLE tries (
  account INTEGER PRIMARY KEY,
  failed INTEGER NOT NULL,
  wait_s INTEGER NOT NULL,          -- from the last wrong try on
  last_us INTEGER NOT NULL,
  row_n INTEGER NOT NULL DEFAULT 0,
  row_digest BLOB
) STRICT;
INSERT INTO tries (account, failed, wait_s, last_us)
  SELECT id, failed, CASE WHEN failed < 5 THEN 0 ELSE min(30 << min(failed - 5, 10), 3600) END, 0 FROM account WHERE failed > 0;
ALTER TABLE account DROP COLUMN failed;
