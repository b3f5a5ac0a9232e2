/** The texts of a commissioning's page. The other languages have the same keys. */
export const en = {
  title: 'Commissioning', daily: 'Daily check', by: '{device}, serial number {serial}, by {operator}',
  rule: 'Nobody may be attached to the device. Stand where you reach its emergency stop.',
  stop: 'Stop', language: 'Language', theme: 'Dark or light', steps: 'Steps', to: 'to', yes: 'Yes', no: 'No', go: 'Go on', done: 'Done',
  states: ['not yet', 'now', 'done', 'failed'],
  step: {
    identify: 'Which device', home: 'Mark and zero', signs: 'Signs', 'scale-and-travel': 'Scale and travel', gravity: 'Gravity',
    'mass-friction-delay': 'Mass, friction, delay', 'known-weight': 'Known force', watchdog: 'Watchdog', 'emergency-stop': 'Emergency stop',
    'range-stops': 'Whole range', 'effort-limit': 'Effort limit', passport: 'Passport',
  } as Record<string, string>,
  finding: {
    'carried-by': 'carried by', 'moves-at-plus': 'moves in + direction at', 'moves-at-minus': 'moves in − direction at', travel: 'travel', mass: 'mass',
    damping: 'damping', 'dry-friction': 'dry friction', delay: 'delay', 'known-force': 'known force', 'carried-with': 'carried with', 'let-go-after': 'let go after',
    'responds-up-to': 'responds as measured up to', 'drive-lag': 'lag of the drive',
  } as Record<string, string>,
  away: { x: 'away from you', y: 'to your left', z: 'up' } as Record<string, string>,
  axis: 'axis {name}',
  plus: 'in its + direction (a finger: closing)',
  ask: {
    device: 'Is this the device with serial number {serial}?', deviceMore: 'Driver {driver}, firmware {firmware}. Compare the label on the device.',
    nobody: 'Is nobody attached to the device?', nobodyYes: 'Nobody is attached', nobodyNo: 'Somebody is', nobodyMore: 'Put the device on its mark, where you will put it every day. Take everybody out of it. It may move from now on.',
    push: 'Push {axis} {way}', pushMore: 'By about a tenth of its range. Leave it there.',
    travel: 'Move {axis} from stop to stop', travelMore: 'Slowly, by hand, to one stop and then to the other. Measure how far that is.', travelField: 'Distance',
    force: 'Pull {axis} with a known force', forceMore: 'Against its + direction, with a weight over a pulley or a spring scale: {lower} to {upper} {unit}.', forceField: 'Force',
    estop: 'Release the emergency stop', estopMore: 'It has cut the device off. Release it, then press Done.',
    next: 'This step failed', nextMore: 'Change it, then repeat the step.', repeat: 'Repeat: {step}', check: 'Check again', earlier: 'Repeat an earlier step', end: 'End', noNumber: 'A number above 0, without a unit.',
  },
  motion: [
    'It may home itself. Only its emergency stop ends that.', '{axis} is pushed, both ways.', 'The effort that carries {axis} is measured.',
    '{axis} is driven along its range.', '{axis} is measured.', 'Its watchdog is pulled.', 'Press the emergency stop at the device while you hold.',
  ],
  hold: 'Hold to move', holdMore: 'With the pointer, or with the space bar. The device moves for as long as you hold, and stops when you let go.', held: 'It moves: let go to stop', ready: 'Nothing moves until you hold.',
  lead: 'Lead from here', leadHead: 'Nobody leads', leadMore: 'One console leads. All others watch.', watchHead: 'Another console leads', watchMore: 'You watch. You can stop the device.', takeOver: 'Take over',
  wait: 'A moment', waitMore: 'The program works. Nothing moves.', connecting: 'Connecting', lost: 'Connection lost', lostMore: 'Whatever moved was taken to neutral. The page connects again by itself.',
  elsewhere: 'No device is commissioned here', elsewhereMore: 'Start: wholehand device commission --web',
  finished: 'The passport is written', finishedDaily: 'Checked for today', finishedMore: 'Recording of all moves: {recording}', needsDaily: 'It lasts 30 days. Check the device every day before its first use.',
  why: 'Found', remedy: 'To do',
};
export type CommissionTexts = typeof en;
