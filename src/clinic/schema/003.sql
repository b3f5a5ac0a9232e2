-- Marks of doubles that were merged into a patient: erased with the patient, they stay erased, too.
CREATE TABLE merged (
  patient INTEGER NOT NULL REFERENCES patient (id) ON DELETE CASCADE,
  mark TEXT NOT NULL UNIQUE
) STRICT;
CREATE INDEX merged_of_patient ON merged (patient);
