/** An entry of /api/recordings. */
export interface Recording {
  name: string;
  created_utc?: string;
  duration_s?: number;
  bytes?: number;
  /** Number of ticks that could not be written because the disk was full. */
  ticks_missing?: number;
  /** The program is writing it now; it can be replayed up to the present. */
  being_written?: boolean;
  title?: string;
  /** Code of the person whose profile was open. */
  profile?: string;
  report?: boolean | string;
}
