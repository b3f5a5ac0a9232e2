/** The texts of the clinic's page. The other languages have the same keys. */
export const en = {
  title: 'Wholehand: clinic', clinic: 'Clinic', places: 'Places', close: 'Close', again: 'Try again', console: 'Open the console', todayWord: 'today',
  visitOpen: 'Open visit', backToVisit: 'Back to the visit',
  names: { hide: 'Hide names', show: 'Show names' },
  silentSince: 'Records do not answer since {at}. The session, Stop and Pause go on.', waiting: 'Waiting on this machine: {n}.',
  silentNow: 'The records do not answer.',
  answerAgain: 'The records answer again.',
  stages: {
    looking: { title: 'Looking for the records', words: 'One moment …' },
    without: { title: 'No records on this station', words: 'Start the program with a folder for them: wholehand run --clinic FOLDER, or ./start --clinic FOLDER.' },
  },
  alone: {
    begin: 'Session without records', title: 'Session without records', words: 'Under the gentle preset. It is recorded. When the records answer again you give it to a patient, or delete it.',
    visitGoesOn: 'The open visit goes on', visitWords: 'With its limits. Its plan and its name come back with the records.', wrongSide: 'The station has the {side} set up. Change hand and device, or choose the other hand in the console.', leave: 'To the patients as they were read last',
  },
  refusals: {
    locked: 'The records are locked. Enter the pass phrase.', not_signed_in: 'Please sign in again.', hidden: 'Names are hidden. Enter your PIN.',
    wrong_pin: 'Wrong PIN. Tries left: {tries_left}.', too_many_tries: 'Too many tries. Wait {wait_s} s.', wrong_phrase: 'That is not the pass phrase, nor the recovery code.',
    not_found: 'It is no longer in the records.', code_exists: 'Another patient has this code.', changed: 'Somebody else changed it meanwhile.', visit_open: 'Another visit is open. End it first.',
    station: 'The station refused: {why}', station_silent: 'The station did not answer within 5 s. Try again.', no_recording: 'There is no recording of it.',
    database: 'The records cannot be saved: {why}', busy: 'The records are busy. Try again.',
  } as Record<string, string>,
  sides: { right: 'right hand', left: 'left hand', both: 'both hands' },
  helps: { full: 'Full', some: 'Some', none: 'None' }, helpOf: 'Help: {help}', min: '{n} min',
  presets: { usual: 'Usual', gentle: 'Gentle', strong: 'Strong', first: 'First visit', short: 'Short', long: 'Long' } as Record<string, string>,
  results: {
    poured_total_l: 'Poured', spilt_l: 'Spilt', bands_done: 'Levels done', time_s: 'Time',
    active_min: 'Active minutes', score: 'Score', reach_s: 'Time to reach', peak_speed_m_s: 'Peak speed', path_ratio: 'Path over straight line', helped_share: 'Helped',
  } as Record<string, string>,
  curves: { one: 'One visit so far. Curves stand here after two.', short: 'under a minute', none: 'Nothing measured yet.', image: '{name} over {n} visits, from {first} to {last}.' },
  first: {
    title: 'First start', words: 'The pass phrase opens the records once a day. Without it, and without the recovery code, nobody can read them again.',
    folder: 'The records are made in {path}.', folderEmpty: 'The folder is empty.', folderAsk: 'If there were records before: is its disk mounted?',
    phrase: 'Pass phrase', phraseHint: '8 characters or more', again: 'Pass phrase again', tile: 'Who works here', name: 'Name', pin: 'PIN', pinHint: '4 to 8 digits', make: 'Make the records',
    short: 'Please use 8 characters or more.', differs: 'The two are not the same.', noName: 'Please enter a name.', badPin: 'Please enter 4 to 8 digits.',
    code: { title: 'Recovery code', words: 'It opens the records if the pass phrase is forgotten. It is shown this once.', paper: 'Print it and lock it away, not beside this computer.', print: 'Print', kept: 'I have it on paper', on: 'Go on' },
  },
  tile: { colour: 'Colour', colours: ['Green', 'Blue', 'Purple', 'Brown', 'Violet', 'Red'] },
  unlock: { mistyped: 'The code was mistyped. Compare it with the printed one, group by group.', title: 'Open the records', words: 'Once a day, and after a restart.', phrase: 'Pass phrase', code: 'Recovery code', open: 'Open', byCode: 'Use the recovery code', byPhrase: 'Use the pass phrase' },
  who: { title: 'Who works?', again: 'Names are hidden', kept: 'What you typed is kept.', pin: 'PIN', ok: 'OK', back: 'Delete the last digit', other: 'Somebody else' },
  picker: { find: 'Name or code', cancel: 'Cancel', nobody: 'Nobody of that name or code.' },
  patients: {
    title: 'Patients', find: 'Name or code', fresh: 'New patient', count: '{n} patients', countOne: '1 patient', name: 'Name', code: 'Code', hand: 'Hand', last: 'Last visit', visits: 'Visits', never: 'none yet',
    empty: 'No patients yet.', nobody: 'Nobody is called “{find}”.', failed: 'Not read since {at}. It is tried again by itself; if it stays so, start the program again.', asOf: 'The list is as of {at}.',
    open: 'open', unfinished: 'unfinished', goOn: 'Go on', endIt: 'End it', without: 'Visit without a patient', withoutMore: 'Under the gentle preset. You give it to a patient later, or delete it.', beginWith: 'Begin, {side}',
    sessions: { title: 'Sessions without a patient', words: 'Recorded while the records did not answer, or outside of a visit.', choose: 'Choose the session of {day}, {at}', give: 'Give to a patient', whose: 'Whose session was it?', more: 'And {n} more.' },
    noPatient: 'no patient', give: 'Give to a patient', giveTo: 'Whose visit was it?', giveYes: 'Give it to {name}, {code}', remove: 'Delete', removeYes: 'Delete for good',
  },
  plan: {
    add: 'Add an exercise', exercise: 'Exercise {n}', level: 'Level of exercise {n}', levelShort: 'Level', help: 'Help in exercise {n}', less: 'Less time for exercise {n}', more: 'More time for exercise {n}', up: 'Exercise {n} earlier', remove: 'Remove exercise {n}',
  },
  form: {
    title: 'New patient', edit: 'Edit patient', person: 'Person', hands: 'Size of the hand', limits: 'Forces', plan: 'Plan', preset: 'Start with', planPreset: 'Start with', ownPlan: 'own plan', save: 'Save', back: 'Discard',
    fields: { name: 'Name', code: 'Code', born: 'Birth date', number: 'Number', side: 'Affected side', hands: 'Hands', preset: 'Forces', parameters: 'Reach and fingers', warnings: 'Warnings', plan: 'Plan' },
    hints: { code: 'not a name', born: 'optional', number: 'optional', warnings: 'seen before each visit' } as Record<string, string>,
    length_m: 'Length', breadth_m: 'Breadth', measure: 'Length: wrist crease to the tip of the middle finger. Breadth: across the knuckles, without the thumb.', handImage: '{side}, {length} mm long, {breadth} mm broad', sideFirst: 'Choose the affected side first.',
    reach: 'Reach and fingers', kept: 'This was typed before and is not saved yet.', stays: 'What you typed stays here.', noName: 'Please enter a name.', bornLater: 'That day has not been yet.', noSide: 'Please choose a side.',
    both: { title: 'Changed by somebody else', words: 'This patient was saved on another screen while you typed.', yours: 'Yours', now: 'Saved there', mine: 'Save mine', theirs: 'Take theirs' },
  },
  patient: {
    patient: 'Patient', reading: 'Reading …', failed: 'Not read since {at}. It is tried again by itself.', asOf: 'Shown as of {at}.', visitCount: '{n} visits', oneVisit: '1 visit', lastOn: 'last on {day}', noVisit: 'no visit yet',
    progress: 'Progress', progressSince: 'Progress since {day}', noProgress: 'Curves stand here after two visits.', noClaim: 'Values as measured; none is a judgement.', visits: 'Visits', noVisits: 'No visits yet.', csv: 'Save as CSV', print: 'Print progress', all: 'Show all {n}', newest: 'Show the newest only',
    active: 'active', painWords: 'pain before {before}, after {after}', nothingDone: 'Nothing was done.', look: 'Look at it', move: 'Move', open: 'open', unfinished: 'unfinished', noShow: 'did not come', helped: 'helped {share} %', notByPerson: 'not moved by a person', waiting: 'being measured', failedTrial: 'not measured: {why}', partly: 'of a part: the recording is not whole', noRecording: 'no recording',
    replay: 'Replay', report: 'Report', compare: 'Compare', notes: 'Notes', person: 'Person', edit: 'Edit', born: 'Born', number: 'Number', hand: 'Size, {side}', preset: 'Forces',
    more: 'Mistakes and rare things', noShowNote: 'Did not come today', noShowYes: 'Note it', moveTitle: 'To whom does the visit of {day}, {at} belong?', moved: 'The visit is now at {name}, {code}.', moveYes: 'Move to {name}, {code}', remove: 'Delete this patient', removeYes: 'Delete {name} for good',
    merge: { title: 'Join with a double', which: 'Who is the double of {name}, {code}?', yes: 'Join: {name}, {code} is removed, and the visits of both stand here', done: '{name}, {code} was joined with this patient.' },
    erase: { title: 'Erase everything', words: 'Visits, notes and recordings are deleted for good, in backups within 30 days.', code: 'Type the code {code}', wrong: 'That is another code.', press: 'Erase everything', done: 'Erased. The last backup that knows the person is gone in 30 days.' },
  },
  notes: {
    write: 'Write a note. It is kept as you type.', done: 'Note done', none: 'No notes yet.', states: { empty: '', typing: 'kept here', saved: 'saved', waits: 'kept here, saved when the records answer' },
    kinds: { tired: 'Tired', spasm: 'Spasm', cue: 'Cue given', hands_on: 'Hands-on', next: 'Next time', reason: 'Why nothing was done' } as Record<string, string>,
  },
  pain: { unasked: 'not asked', before: 'Pain before', after: 'Pain now', notAsked: 'Not asked', of: 'Pain {n} of 10' },
  today: { title: 'Today', from: 'As on {day}', fromPlan: 'From the plan', begin: 'Begin visit {n}', goOn: 'Go on with the visit', preparing: 'The hand is certified and rehearsed, 20 s at most.', openSince: 'Open since {at}, begun by {who}.', otherOpen: 'Go to the open visit', side: 'Which hand today?', change: 'Change plan', ready: 'Plan is ready', noPlan: 'The plan is empty. Add an exercise.', notNow: 'A visit cannot begin while the records do not answer. A session without records can, under the gentle preset.' },
  visit: {
    title: 'Visit', plan: 'Plan', noPatient: 'No patient', gentle: 'gentle preset', hiddenName: 'Name hidden', recorded: '● Recording', unrecorded: 'Not recorded', itemOf: '{n} of {m}', active: 'active: {item} of {of} min, visit {all}', inProgress: 'now', done: 'done', setUp: 'Set up',
    next: 'Next in plan', nextIs: 'Next: {name}', end: 'End visit', stop: 'Stop gently', marks: 'Note with one touch', noteTitle: 'Notes', pain: 'Pain', another: 'Another visit is open.', over: 'This visit has ended.', endedElsewhere: 'This visit was ended on another screen, {at}.',
    whichHand: 'Which hand is in the device?', whichHandMore: 'Look at the person, then press. Start works after that.', wrongSide: 'This visit is for the {side}. Change the device, or end this visit and begin one for the other hand.',
    notSetUp: 'The station does not have this visit’s settings. Press “Set up” beside an exercise.', doesNotStop: 'It has not stopped. Press Emergency stop.', staysAsItIs: 'The exercise stays as it is.',
  },
  end: {
    title: 'End of visit', doneTitle: 'Done', nothing: 'Nothing was done in this visit.', notDone: 'not done', of: '{done} of {planned}', result: 'Result', now: 'Today', last: '{day}', lastNone: 'before', noResults: 'No results.',
    next: 'What comes next', reason: 'Why nothing was done', finish: 'Finish visit', unfinished: 'Leave it unfinished', back: 'Back to the exercise',
    card: { title: 'Your training today', trained: 'You trained for {min}.', next: 'Next time:', nextPatient: 'Next patient', toPatient: 'Look at the visit', print: 'Print the card' },
  },
  sheet: { back: 'Back to {name}', print: 'Print', nothing: 'There is nothing to print yet.', progress: 'Progress', visit: 'Visit of', day: 'Day', hand: 'Hand', done: 'Done', active: 'Active', pain: 'Pain before → after' },
  settings: {
    title: 'Settings', people: 'Who works here', newPerson: 'Somebody new', name: 'Name', add: 'Add', backupProblem: 'It failed: {why}', backup: 'Backup', noFolder: 'No folder for backups is set. Start the program with one.', noBackup: 'No backup yet in {folder}.', lastBackup: 'Last backup: {day}, {at}, in {folder}.',
    export: 'Export', exportWords: 'All patients by code, without names.', csvAll: 'Save as CSV', leaving: 'End of the day', lockWords: 'Locked, the records need the pass phrase again.', signOut: 'Sign out', lock: 'Lock the records',
  },
};

export type ClinicTexts = typeof en;
