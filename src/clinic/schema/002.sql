-- What was set in a visit, by a press, and is the person's from its end on. All JSON.
ALTER TABLE visit ADD COLUMN in_force TEXT NOT NULL DEFAULT '{}';  -- parameters and help that the station had when last looked at
ALTER TABLE visit ADD COLUMN changed TEXT NOT NULL DEFAULT '{}';   -- parameters that were set for the person
ALTER TABLE visit ADD COLUMN before TEXT NOT NULL DEFAULT '{}';    -- the person's own in their place; null: none

-- A session that was recorded outside of a visit is measured, and belongs to nobody yet.
UPDATE trial SET state = 'measured'
  WHERE visit IS NULL AND state = 'ignored' AND json_extract(measures, '$.visit') = 0
    AND json_extract(measures, '$.recording.ticks') > 0;
