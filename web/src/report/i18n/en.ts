/** The texts of the report. The other languages have the same keys. */
export const en = {
  title: 'Report: {name}', report: 'Report', replay: 'Look at it again', print: 'Print', therapy: 'Therapy', engineering: 'Engineering',
  pageOf: 'Page {n} of {m}', program: 'Program {version}', notDiagnosis: 'Not a diagnosis. Every number comes from the recording.',
  reading: 'The report is being read …', none: 'none', time: 'Time', seconds: 's',
  facts: { patient: 'Patient', hand: 'Hand', device: 'Device', exercise: 'Exercise', date: 'Date', length: 'Length', file: 'File', simulated: 'simulated', noExercise: 'No exercise', unknown: 'not stated' },
  tiles: {
    levels: 'levels finished', of: 'of {n}', reach: 'to reach, on average', grip: 'grip force, on average', steadiness: 'grip varies by',
    touched: 'objects touched', held: 'held in all', force: 'largest contact force', effort: 'largest effort, {axis}',
  },
  whose: {
    who: ['nobody', 'the person', 'the virtual patient', 'a replayed motion'], moved: '{who} had the hand {n} % of the time ({time})',
    active: 'Active for {time}', activeHelped: '{time} of it with some help', led: 'led for {time}',
    helps: ['', 'with full help', 'with some help', 'without help'], helped: 'Of the person: {helps}.',
    person: 'the person’s', shared: 'shared, {n} % the person’s', shown: ['nobody moved', 'the person’s', 'shown by the virtual patient', 'shown by a replayed motion'],
    unknown: 'This recording does not say who moved the hand: it is older, and its hand was simulated.',
    things: { band_held: 'bands', level_done: 'levels', reach: 'reaches', grip: 'grips' } as Record<string, string>,
    apart: '{what}: {n}', sharedCount: '{n} shared', othersCount: '{n} not the person’s', touches: 'touches: {n}', notCounted: 'Not counted: {what}.',
    rule: 'A part of the exercise, a level, reach, grip or touch counts where the person moved the hand in every tick from its first to its last; what somebody else moved in part is shared, and in no sum.',
  },
  before: { was: 'before: {x}', better: 'better', compared: 'Before: {name}, {date}.', other: 'It differs in: {what}.', not: 'Not compared: {what}.', nothing: 'No figure can be compared.' },
  steadinessNote: 'Grip: force of at least 1 N for at least 1 s. It varies by its standard deviation, as a share of its mean; the first and last 0.25 s of each grip do not count.',
  happened: {
    title: 'Stops and faults', emergency_stop: 'Emergency stop', stop: 'Stop', fault: 'Fault', controls_lost: 'Controls lost', missing: 'Missing ticks', missed: 'Skipped periods', limited: 'Effort at its limit',
    at: 'at {times}', more: '{times} and {n} more', ticks: '{n} ticks', lost: '{n} ticks, {s} s', unreadable: 'From {time} on the file cannot be read.', unreadableEnd: 'The end of the file cannot be read.',
    written: 'The recording was still being written.', brokenOff: 'The session was broken off: the recording has no end, because the program or the machine failed, or the disk was full.', truncated: 'More happened than this page holds.',
  },
  picture: { caption: 'Strongest contact: {n} N at {time}', last: 'At the end, {time}', none: 'No picture: this browser has no WebGL. Everything else works.', noScene: 'No picture: {why}', drawing: 'The picture is being drawn …' },
  bodies: { title: 'What was held', body: 'Object', first: 'First at', touches: 'Touches', longest: 'Longest touch, s', held: 'Held, s', force: 'Force, N', way: 'Moved, cm', nothing: 'No figure can be compared.', noBodies: 'There was nothing to touch.', more: 'and {n} more', note: 'Held: fingers on one side, thumb or palm on the other, or a grip that the exercise counts.' },
  charts: {
    grip: 'Grip force', goal: 'asked for', contact: 'Contact force', limits: 'Effort limits in force', effortHand: 'Effort, hand', effortArm: 'Effort, arm', phi: 'Adaptive damping φ', alpha: 'Wall of the exercise α',
    handPosition: 'Position, hand', armPosition: 'Position, arm', palm: 'Palm to the nearest object', count: 'Contact points', times: 'Time per tick', timesCpu: 'CPU time per tick', ticks: 'ticks', click: 'Click a chart: look at that moment.', missing: 'Pale red: missing.', touchesLeftOut: 'Not shaded: {n} more touches; they are in the figures.', limitsThinned: 'Changes of a limit within {s} s are drawn as one.', touches: 'Shaded: the hand touches something.',
  },
  compared: {
    title: 'Told apart', threshold: 'Three of four differences of {n} % are felt ({interval}).', between: '95 %: {a} to {b} %', below: '95 %: below {n} %', above: '95 %: above {n} %', atLimit: 'This is at the device’s limit.',
    notEnough: 'Not enough for a threshold: {why}.', answers: 'Answers: {n}{by}.', other: 'Who compares only the depth of the squeeze is right in {n} %.', notPersons: 'Not a person’s: somebody else moved the hand.',
    why: { answers: '{n} more answers are needed', guesses: 'the answers do not follow the differences', one_answer: 'nearly all answers are the same', compares_other: 'the depth of the squeeze explains the answers better', misses_catches: 'large differences were missed', beyond_range: 'with these differences only thresholds up to {most} % are stated' } as Record<string, string>,
    by: { squeeze: '{n} by squeezing', player: '{n} by key or touch', therapist: '{n} said by the therapist', earlier: '{n} before a rest' } as Record<string, string>,
    chart: '“The second was more”, by how much it was', fitted: 'fitted', points: 'answers',
  },
  stages: {
    title: 'CPU time of a tick, µs', stage: 'Stage', max: 'max', whole: 'whole tick',
    names: { device_read: 'device read', observe: 'observe', dynamics: 'dynamics', control: 'control', exercise: 'exercise', safety: 'safety', device_write: 'device write', physics_step: 'physics step', contacts: 'contacts' } as Record<string, string>,
  },
  faults: { title: 'Faults by ticks', fault: 'Fault', ticks: 'Ticks', axis: 'Mostly on' },
  settings: {
    title: 'Settings', scene: 'Scene', rendering: 'Rendering', engine: 'Physics engine', rate: 'Rate', simulatedClock: 'simulated clock', realTime: 'real time', gains: 'Gains', accepted: 'accepted', uncertified: 'NOT certified', paper: 'the paper’s own law',
    passport: 'Passport', seed: 'Seed', deadlines: 'Deadlines missed', damped: 'Damping φ above 0.5', share: '{n} % of the time', coupling: 'Largest coupling error', work: 'Work of the device', limits: 'Device limits',
  },
  problems: {
    template: 'This page carries no recording. Make a report with: wholehand replay --report report.html RECORDING.h5', old: 'This browser is too old for this page. Open it with a browser of 2023 or later.',
    broken: 'The data of this page cannot be read. Make the report again.', says: 'Reason:',
  },
};

export type ReportTexts = typeof en;
