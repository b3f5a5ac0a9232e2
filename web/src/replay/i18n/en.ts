/** The texts of the replay. The other languages have the same keys. */
export const en = {
  title: '{name}: replay', brand: 'Replay',
  report: 'Report', reportOf: 'Report of {name}',
  making: 'The report is being made … {s} s', makingLine: 'Under way', opening: 'The recording is being opened …', loading: '{percent} % read',
  sides: { a: 'A', b: 'B' },

  transport: {
    title: 'Playing', play: 'Play', pause: 'Pause', space: 'Space', back: 'One tick back', forward: 'One tick on', home: 'To the beginning', end: 'To the end',
    earlier: 'To the mark before', later: 'To the next mark', speed: 'Speed', zoomIn: 'Shorter window', zoomOut: 'Longer window', whole: 'All of it',
    tick: 'tick {n} of {m}', near: 'being read …', window: 'Window {a} to {b}',
  },
  timeLine: {
    title: 'Time line', position: '{time}, {tick}', begin: 'Begin of the window', end: 'End of the window',
    help: 'Arrows: one tick. With Shift: a tenth of a second. Page keys: marks. Plus and minus: the window.',
  },
  plots: {
    image: '{name}, {a} to {b}. Press “Tables” for numbers.', tableCaption: '{name}, in the window', latest: 'At the play head',
    intention: 'intended', parts: 'Effort, {axis}', sent: 'sent', exercise: 'exercise', damping: 'damping',
    contact: 'Contact', force: 'force', count: 'contacts', palm: 'Palm to object', distance: 'distance', duration: 'Time per tick', took: 'took',
    value: 'Exercise', valueOthers: 'Measured, for engineers', valueChoice: 'Value of the exercise', hint: 'Click: go there. Pull: zoom in. Ctrl and wheel: longer or shorter.',
    title: 'Plots',
  },
  facts: {
    title: 'Recording', when: 'When', exercise: 'Exercise', hand: 'Hand', patient: 'Patient', device: 'Device', simulated: 'simulated', length: 'Length',
    ticks: '{n} ticks', missing: 'Missing', end: 'Ended', ends: { stop: 'by somebody', fault: 'by a fault', broken_off: 'broken off: the recording has no end' } as Record<string, string>, program: 'Program', result: 'Result', noExercise: 'None',
  },
  moments: {
    title: 'Marks', none: 'Nothing happened in this window.', more: '{n} of {m}, around the play head. A shorter window shows fewer.', gap: '{n} ticks are missing',
    kinds: {
      stop: 'Stop', emergency_stop: 'Emergency stop', fault: 'Fault', controls_lost: 'Controls lost', armed: 'Armed', neutral: 'At neutral',
    } as Record<string, string>,
    short: { stop: 'stop', emergency_stop: 'emergency stop', fault: 'fault', controls_lost: 'controls lost', armed: 'armed', neutral: 'neutral', gap: 'gap' } as Record<string, string>,
    events: {
      approached: 'Near an object', touched: 'Touched', engaged: 'Grasped', disengaged: 'Let go',
      level_done: 'Level done', paused: 'Paused', resumed: 'Resumed', restarted: 'Restarted',
    } as Record<string, string>,
  },
  notices: {
    differs: 'Differs from A in: {what}.', axesOfOne: 'Axes of one recording only: {axes}.',
    failed: '{name} is not shown. {why}',
    written: 'This recording is still being written.', readOn: 'Read on',
    damaged: 'From {time} on the file cannot be read.', damagedEnd: 'The end of the file cannot be read.', holes: '{n} ticks are missing: marked on the time line.',
    noPicture: 'No picture: {why}', noPictureAtAll: 'No picture: the scene cannot be built from this file.', noExercise: 'Recorded without an exercise.',
    gone: 'The program does not answer. What was read stays; the rest comes when it is back.', retry: 'Try now',
    piece: 'A part of the recording could not be read: {why}', empty: 'The recording has no ticks.',
  },
  problems: {
    unknown: 'There is no recording of this name.', denied: 'The program wants a token. Open the replay from the console.',
    unreadable: 'This recording cannot be opened.', gone: 'The program does not answer.', nonsense: 'The program answers something this page does not understand. Reload the page; if that does not help, update the program.',
    none: 'The address names no recording: /replay?recording=NAME. The console lists them.', says: 'The program says:', again: 'Try again', console: 'To the console',
  },
};

export type ReplayTexts = typeof en;
