/** The texts of the console. The other languages have the same keys. */
export const en = {
  title: 'Wholehand: console',
  hand: { right: 'right hand', left: 'left hand' },
  session: 'Session {n}',
  level: 'Level {n}',
  levelOf: 'Level {n} of {m}',
  exercises: { 'game-scene': 'Bodies of a game', 'free-grasping': 'Free grasping', 'squeeze-to-level': 'Squeeze to a level',
    drawer: 'Drawer', 'cupboard-door': 'Cupboard door', 'light-switch': 'Light switch', 'coffee-mill': 'Coffee mill', 'flip-top-lid': 'Flip-top lid', 'press-lever': 'Press lever',
  } as Record<string, string>,
  hands: {
    'adult-median-right': 'Median, right', 'adult-median-left': 'Median, left',
    'woman-p05-right': 'Woman P5, right', 'woman-p50-right': 'Woman P50, right', 'woman-p95-right': 'Woman P95, right',
    'woman-p05-left': 'Woman P5, left', 'woman-p50-left': 'Woman P50, left', 'woman-p95-left': 'Woman P95, left',
    'man-p05-right': 'Man P5, right', 'man-p50-right': 'Man P50, right', 'man-p95-right': 'Man P95, right',
    'man-p05-left': 'Man P5, left', 'man-p50-left': 'Man P50, left', 'man-p95-left': 'Man P95, left',
  } as Record<string, string>,
  virtualPatient: 'Virtual patient: {name}', virtualPlays: 'the virtual patient plays',
  patients: {
    'relaxed-adult': 'Relaxed adult', 'stiff-adult': 'Stiff adult', 'no-arm': 'No arm', tremor: 'Tremor', spastic: 'Spasticity',
    releases: 'Lets go', slams: 'Slams', fights: 'Fights back', 'enslaved-fingers': 'Linked fingers', 'spastic-fist': 'Spastic fist',
    'pill-rolling': 'Pill-rolling tremor', 'holds-a-ball': 'Holds a ball', weak: 'Weak hand',
  } as Record<string, string>,
  noExercise: 'No exercise',

  states: {
    connecting: 'Connecting', lost: 'Connection lost', disarmed: 'Disarmed', rendering: 'Rendering',
    paused: 'Paused', stopping: 'Stopping', stopped: 'Stopped', faulted: 'Faulted',
    armed: 'Armed',
  },
  pill: {
    connecting: 'Waiting for the program', lost: 'Nothing here is live', disarmed: 'Nothing pushes',
    rendering: 'All limits kept', limited: 'Effort at its limit', paused: 'The exercise waits',
    stopping: 'On the way to neutral', stopped: 'At neutral', faulted: 'At neutral',
  },

  engineer: 'Engineer’s view', therapy: 'Therapist’s view',
  theme: 'Dark or light',
  language: 'Language',
  tables: 'Tables instead of plots',
  pause: 'Pause', resume: 'Resume', arm: 'Start', armAgain: 'Arm again', stop: 'Stop gently',
  emergency: 'Emergency stop',
  space: 'Space', esc: 'Esc',

  sessionLine: {
    since: 'since {at}: {min} min active, repetitions: {n}', ended: 'ended {at}: {min} min active, repetitions: {n}',
    next: { disarmed: 'Next: press Start when the person is ready.', paused: 'Next: press Resume to go on.', stopped: 'Next: read the report, choose the next exercise, or arm again.', faulted: 'Next: do what Safety says, then arm again.', lost: 'Next: see that the program runs.', rested: 'The player rests, and goes on alone.' } as Record<string, string>,
  },
  big: { title: 'Set with one touch', less: 'Less: {name}', more: 'More: {name}' },

  plots: {
    hand: 'Effort, hand', arm: 'Effort, arm', axis: 'Coordinate', ratios: 'φ and α',
    device: 'device', avatar: 'avatar', limit: 'limit', now: 'now', axisChoice: 'Axis',
    image: '{name}: the last 10 seconds. Press “Tables” for numbers.',
    series: 'Series', latest: 'Now', least: 'Least', most: 'Most',
    tableCaption: '{name}, last 10 seconds', fault: 'fault', stop: 'stop',
  },
  axes: {
    x: 'x', y: 'y', z: 'z', roll: 'roll', pitch: 'pitch', yaw: 'yaw',
    finger_flexion: 'fingers', thumb_circumduction: 'turn', thumb_flexion: 'thumb',
  } as Record<string, string>,
  axesLong: {
    x: 'x, away', y: 'y, left', z: 'z, up', roll: 'Roll', pitch: 'Pitch', yaw: 'Yaw',
    finger_flexion: 'Fingers', thumb_circumduction: 'Thumb, turn', thumb_flexion: 'Thumb, bend',
  } as Record<string, string>,
  axesKey: {
    x: 'x', y: 'y', z: 'z', roll: 'ro', pitch: 'pi', yaw: 'ya',
    finger_flexion: 'f', thumb_circumduction: 'c', thumb_flexion: 't',
  } as Record<string, string>,
  phases: { bump: 'touched', engaged: 'grasp, wall fades in' },

  legend: { title: 'Legend', phi: 'φ: adaptive damping of an axis; 0 none, 1 full', alpha: 'α: how far the exercise’s wall is faded in; 0 out, 1 in', m1: '① the hand touches an object', m2: '② grasped, the wall fades in' },
  profile: { profile: 'Patient: {name}', noProfile: 'no profile', name: 'Name of the patient’s profile', save: 'Save', load: 'Open', nameHint: 'New name', rule: 'Only A to Z, digits, “-” and “_”; 60 at most.', stopFirst: 'Stop first: a profile is opened before the start.' },
  handFacts: { now: 'Hand', side: 'Side', right: 'right', left: 'left', range: '{lo} to {hi}', of: 'Range of the device' },

  view: {
    title: '3D view', skin: 'Skin', colliders: 'Colliders', choice: 'Hand drawn as',
    none: 'No 3D view: this browser has no WebGL. Everything else works.',
    loading: 'The 3D view is being built …',
  },

  exercise: { title: 'Exercise' },

  safety: {
    title: 'Safety', peaks: 'peaks of the last 10 s', state: 'State',
    noFault: 'No fault', cause: 'Cause: {what}',
    nothingYet: 'Nothing has happened since the start.',
    lastNotice: '{time}: {what}',
    disarmed: 'Not started', disarmedWhat: 'The device pushes nothing. Start when the person is ready.',
    stopping: 'Effort ramps to neutral', stoppingWhat: 'It ends within a tenth of a second. The arm is carried.',
    stopped: 'Stopped on request', stoppedWhat: 'Effort is at neutral, the arm is carried. Arm again when ready.',
    faultedWhat: 'Effort ramped to neutral within 0.1 s. The arm is carried.',
    rehearsing: 'Rehearsal before the first force', rehearsingWhat: '{ticks} ticks so far. It starts when all are fast enough.',
    armed: 'Armed', armedWhat: 'The effort is being blended in.', emergency: 'Emergency stop was pressed', beyond: '{value}, limit {limit}',
    lost: 'No connection to the program',
    lostWhat: 'If the program runs, the exercise effort fades out by itself. The figures here are from before.',
    fingers: 'Fingers', thumb: 'Thumb', arm: 'Arm x y z', speed: 'Arm speed', of: '{a} of {b}',
  },
  device: {
    title: 'Device', enabled: 'Enabled', notEnabled: 'Not enabled', homed: 'homed', notHomed: 'not homed', silenced: 'let go by its watchdog',
    temperature: 'Temperature {value}', notKnown: 'not known', sample: 'sample {age}', host: 'host {age}', nothingYet: 'none yet',
    letGo: 'The host let go: {why}',
    reasons: {
      loopSilent: 'no new command for 20 ms', silentAtNeutral: 'no new command for 20 ms, the effort was neutral',
      badCommand: 'a command was not sound', loopEnded: 'the loop ended before it was at neutral',
      hostEnds: 'it was asked to end', neverCommanded: 'it was enabled and got no command',
    },
  },
  /** Advice after a fault, by the name of the fault. */
  advice: {
    'device read failed': 'Check the device’s cable and power, then arm again.',
    'device write failed': 'Check the device’s cable and power, then arm again.',
    'non-finite device position': 'Check the device’s cable and power, then arm again.',
    'non-finite effort': 'Load the exercise again, then arm. If it comes back, tell the person who looks after the program.',
    'non-finite state': 'Load the exercise again, then arm. If it comes back, tell the person who looks after the program.',
    'physics step failed': 'Load the exercise again, then arm. If it comes back, tell the person who looks after the program.',
    'singular reduced inertia': 'Load the exercise again, then arm. If it comes back, tell the person who looks after the program.',
    'bodies exploded': 'Load the exercise again, then arm. If it comes back, tell the person who looks after the program.',
    'speed limit exceeded': 'See that the person is calm and the arm is free, then arm again.',
    'workspace left': 'Bring the hand back to the middle, then arm again.',
    'encoder jumped': 'Do not go on with this device until it was checked.',
    'encoder stuck': 'Do not go on with this device until it was checked.',
    'drive fault': 'Look up the drive’s code in its maker’s manual, clear it, then arm again.',
    'enable lost': 'Release the device’s stop button or press its enable button, then arm again.',
    'stale sample': 'Check the device’s cable and power, then arm again.',
    'samples delayed': 'This computer or the device’s line was too slow: end other programs, then arm again.',
    'effort astray': 'A drive did not give the effort that it was sent: have the device looked at before anybody is attached again.',
    'world gives energy': 'Load the exercise again, then arm. If it comes back, tell the person who looks after the program.',
    'late ticks in a row': 'This computer was too slow: end other programs, then arm again.',
    'gap too long': 'This computer was too slow: end other programs, then arm again.',
    other: 'Arm again when the cause is gone.',
  } as Record<string, string>,

  timing: {
    title: 'Time per tick', missed: '{n} missed of {m}', deadline: 'deadline {t}', slower: 'ticks that took longer',
    image: 'How many ticks took longer than a time, in microseconds: half {p50}, one in a hundred {p99}, one in a thousand {p999}, the slowest {max}.',
    max: 'max, µs', dropped: '{n} records dropped',
  },

  setup: {
    help: 'Help in the game', helps: ['Own choice', 'Full', 'Some', 'None'],
    title: 'Session', exercise: 'Exercise', level: 'Level', hand: 'Hand', load: 'Load', steering: 'Who plays',
    virtual: 'Virtual patient', person: 'Person', next: 'Next', restart: 'Restart',
    yours: 'Controls: yours', free: 'Controls: free', others: 'Controls: taken', players: 'Controls: the player’s', therapists: 'Controls: another therapist’s',
    take: 'Take the controls', takeShort: 'Take', giveBack: 'Give back',
  },

  parameters: {
    title: 'Parameters', groups: { 0: 'Patient', 1: 'Hand', 2: 'Exercise' } as Record<number, string>,
    ramp: 'now {now} → {v}', range: '{name}, {lo} to {hi} {unit}', none: 'Nothing to set here.',
    notANumber: 'Please enter a number from {lo} to {hi}.', refused: 'Not changed: {reason}',
    names: {
      effort_limit_hand_tip_n: 'Effort limit, hand',
      effort_limit_arm_n: 'Effort limit, arm',
      damping_full_n: 'Adaptive damping, full at',
      damping_decay_s: 'Damping fades out in',
      wall_stiffness_ratio: 'Wall stiffness',
      viscosity_ratio: 'Viscosity',
      lead_in_m: 'Wall before contact',
      level_ratio: 'Force asked for',
      squeeze_threshold_ratio: 'Squeeze needed',
      line_tolerance_l: 'Tolerance of the line',
      wall_fade_s: 'Wall fades in',
      reach_left_m: 'Reach to the left',
      reach_right_m: 'Reach to the right',
      reach_forward_m: 'Reach forward',
      fingers_open_rad: 'Fingers open to',
      fingers_close_rad: 'Fingers close to',
    } as Record<string, string>,
  },

  recordings: {
    title: 'Recordings', none: 'No recordings yet.', failed: 'The list could not be read. It is tried again.',
    replay: 'Replay', replayOf: 'Replay {name}', beside: 'Replay both', besideOf: 'Beside another: {name}', report: 'Report', download: 'Download', reportOf: 'Report of {name}', downloadOf: 'Download {name}', missing: 'incomplete: {ticks} ticks are missing',
    beingWritten: 'still being recorded',
    all: 'Show all {n}', newest: 'Show the newest only',
    now: 'Recording',
    on: '● Recording', off: 'Not recorded',
  },

  notices: {
    unrecorded: 'This session is not recorded.', unrecordedMore: 'The program says why where it was started.',
    saved: 'Saved: {name}, {figures}.',
    lost: 'Connection lost. The figures are from before.', lostMore: 'If the program runs, the exercise effort fades out by itself.',
    unconfirmed: 'Stop not confirmed: use the red button.', unconfirmedMore: 'This page goes on sending the stop.',
    left: 'You left this page: the controls were given back, and the exercise effort is out until somebody takes them.',
    unheard: 'The program did not hear this page: the controls were given back, and the exercise effort is out until somebody takes them.',
    taken: 'Another therapist took the steering. Everything else you can still do.',
    player: 'The player has the controls. You can pause, stop, set limits, load, and take the steering.',
    therapist: 'Another therapist has the steering. Everything else you can do, too.',
    watching: 'You are watching: this address does not let this page lead. Emergency stop always works.',
    hardware: 'The red button on the robot always works.', retry: 'Try now', attempts: 'Attempt {n} …',
    held: 'A game has the controls. You can pause, stop, set limits, load, and take the steering.',
    version: 'The program speaks version {theirs} of the messages, this page version {ours}. Load the page again.',
    refused: '{what} was refused: {reason}', close: 'Close',
  },
};

export type ConsoleTexts = typeof en;
