-- Who no longer works here keeps the name that stands at notes and in the log, and has no tile.
ALTER TABLE account ADD COLUMN left_us INTEGER NOT NULL DEFAULT 0;      -- 0: works here
