import type { ClinicTexts } from './en';

// Deutsch: Schweizer Rechtschreibung (ss), höfliche Anrede, kurze Sätze.
export const de: ClinicTexts = {
  title: 'Wholehand: Praxis', clinic: 'Praxis', places: 'Bereiche', close: 'Schliessen', again: 'Noch einmal', console: 'Konsole öffnen', todayWord: 'heute',
  visitOpen: 'Offene Sitzung', backToVisit: 'Zurück zur Sitzung',
  names: { hide: 'Namen ausblenden', show: 'Namen zeigen' },
  silentSince: 'Die Akten antworten seit {at} nicht. Sitzung, Stopp und Pause gehen weiter.', waiting: 'Auf diesem Gerät wartet: {n}.',
  silentNow: 'Die Akten antworten nicht.',
  answerAgain: 'Die Akten antworten wieder.',
  stages: {
    looking: { title: 'Die Akten werden gesucht', words: 'Einen Moment …' },
    without: { title: 'Keine Akten an diesem Platz', words: 'Starten Sie das Programm mit einem Ordner dafür: wholehand run --clinic ORDNER, oder ./start --clinic ORDNER.' },
  },
  alone: {
    begin: 'Sitzung ohne Akten', title: 'Sitzung ohne Akten', words: 'Mit den sanften Werten. Sie wird aufgezeichnet. Wenn die Akten wieder antworten, ordnen Sie sie zu oder löschen sie.',
    visitGoesOn: 'Die offene Sitzung geht weiter', visitWords: 'Mit ihren Grenzen. Plan und Name kommen mit den Akten zurück.', wrongSide: 'Das Gerät ist eingestellt für: {side}. Stellen Sie es um, oder wählen Sie in der Konsole die andere Hand.', leave: 'Zu den Personen, wie zuletzt gelesen',
  },
  refusals: {
    locked: 'Die Akten sind verschlossen. Geben Sie das Kennwort ein.', not_signed_in: 'Bitte melden Sie sich noch einmal an.', hidden: 'Die Namen sind ausgeblendet. Geben Sie Ihre PIN ein.',
    wrong_pin: 'Falsche PIN. Noch {tries_left} Versuche.', too_many_tries: 'Zu viele Versuche. Warten Sie {wait_s} s.', wrong_phrase: 'Das ist weder das Kennwort noch der Notschlüssel.',
    not_found: 'Es ist nicht mehr in den Akten.', code_exists: 'Diesen Code hat schon jemand.', changed: 'Jemand anderes hat es inzwischen geändert.', visit_open: 'Eine andere Sitzung ist offen. Beenden Sie sie zuerst.',
    station: 'Das Gerät hat abgelehnt: {why}', station_silent: 'Das Gerät hat 5 s lang nicht geantwortet. Noch einmal versuchen.', no_recording: 'Davon gibt es keine Aufnahme.',
    database: 'Die Akten lassen sich nicht speichern: {why}', busy: 'Die Akten sind beschäftigt. Noch einmal versuchen.',
  },
  sides: { right: 'rechte Hand', left: 'linke Hand', both: 'beide Hände' },
  helps: { full: 'Viel', some: 'Etwas', none: 'Keine' }, helpOf: 'Hilfe: {help}', min: '{n} min',
  presets: { usual: 'Üblich', gentle: 'Sanft', strong: 'Kräftig', first: 'Erste Sitzung', short: 'Kurz', long: 'Lang' },
  results: {
    poured_total_l: 'Eingeschenkt', spilt_l: 'Verschüttet', bands_done: 'Stufen geschafft', time_s: 'Zeit',
    active_min: 'Aktive Minuten', score: 'Punkte', reach_s: 'Zeit zum Ziel', peak_speed_m_s: 'Höchste Geschwindigkeit', path_ratio: 'Weg zu Luftlinie', helped_share: 'Geholfen',
  },
  curves: { one: 'Bisher eine Sitzung. Kurven stehen hier nach zweien.', short: 'unter einer Minute', none: 'Noch nichts gemessen.', image: '{name} über {n} Sitzungen, von {first} bis {last}.' },
  first: {
    title: 'Erster Start', words: 'Das Kennwort öffnet die Akten einmal am Tag. Ohne Kennwort und ohne Notschlüssel kann sie niemand mehr lesen.',
    folder: 'Die Akten kommen nach {path}.', folderEmpty: 'Der Ordner ist leer.', folderAsk: 'Gab es schon Akten: Ist der Datenträger eingehängt?',
    phrase: 'Kennwort', phraseHint: '8 Zeichen oder mehr', again: 'Kennwort noch einmal', tile: 'Wer hier arbeitet', name: 'Name', pin: 'PIN', pinHint: '4 bis 8 Ziffern', make: 'Akten anlegen',
    short: 'Bitte 8 Zeichen oder mehr.', differs: 'Die beiden sind nicht gleich.', noName: 'Bitte geben Sie einen Namen ein.', badPin: 'Bitte geben Sie 4 bis 8 Ziffern ein.',
    code: { title: 'Notschlüssel', words: 'Er öffnet die Akten, wenn das Kennwort vergessen ist. Er wird nur dieses Mal gezeigt.', paper: 'Drucken Sie ihn und schliessen Sie ihn weg, nicht bei diesem Computer.', print: 'Drucken', kept: 'Ich habe ihn auf Papier', on: 'Weiter' },
  },
  tile: { colour: 'Farbe', colours: ['Grün', 'Blau', 'Purpur', 'Braun', 'Violett', 'Rot'] },
  unlock: { mistyped: 'Der Schlüssel ist falsch abgeschrieben. Vergleichen Sie ihn mit dem gedruckten, Gruppe für Gruppe.', title: 'Akten öffnen', words: 'Einmal am Tag, und nach einem Neustart.', phrase: 'Kennwort', code: 'Notschlüssel', open: 'Öffnen', byCode: 'Notschlüssel nehmen', byPhrase: 'Kennwort nehmen' },
  who: { title: 'Wer arbeitet?', again: 'Namen sind ausgeblendet', kept: 'Was Sie geschrieben haben, ist noch da.', pin: 'PIN', ok: 'OK', back: 'Letzte Ziffer löschen', other: 'Jemand anderes' },
  picker: { find: 'Name oder Code', cancel: 'Abbrechen', nobody: 'Niemand heisst so.' },
  patients: {
    title: 'Personen', find: 'Name oder Code', fresh: 'Neue Person', count: '{n} Personen', countOne: '1 Person', name: 'Name', code: 'Code', hand: 'Hand', last: 'Letzte Sitzung', visits: 'Sitzungen', never: 'noch keine',
    empty: 'Noch niemand.', nobody: 'Niemand heisst «{find}».', failed: 'Seit {at} nicht gelesen. Es wird von selbst weiter versucht; bleibt es so, starten Sie das Programm neu.', asOf: 'Die Liste ist von {at}.',
    open: 'offen', unfinished: 'nicht beendet', goOn: 'Weiter', endIt: 'Beenden', without: 'Sitzung ohne Person', withoutMore: 'Mit den sanften Werten. Sie ordnen sie später zu oder löschen sie.', beginWith: 'Beginnen, {side}',
    sessions: { title: 'Sitzungen ohne Person', words: 'Aufgezeichnet, während die Akten nicht antworteten, oder ausserhalb einer Sitzung.', choose: 'Sitzung vom {day}, {at}, wählen', give: 'Zuordnen', whose: 'Wessen Sitzung war es?', more: 'Und {n} weitere.' },
    noPatient: 'ohne Person', give: 'Zuordnen', giveTo: 'Wessen Sitzung war es?', giveYes: 'Zuordnen: {name}, {code}', remove: 'Löschen', removeYes: 'Endgültig löschen',
  },
  plan: {
    add: 'Übung hinzufügen', exercise: 'Übung {n}', level: 'Stufe der Übung {n}', levelShort: 'Stufe', help: 'Hilfe in Übung {n}', less: 'Weniger Zeit für Übung {n}', more: 'Mehr Zeit für Übung {n}', up: 'Übung {n} früher', remove: 'Übung {n} entfernen',
  },
  form: {
    title: 'Neue Person', edit: 'Angaben ändern', person: 'Person', hands: 'Grösse der Hand', limits: 'Kräfte', plan: 'Plan', preset: 'Beginnen mit', planPreset: 'Beginnen mit', ownPlan: 'eigener Plan', save: 'Speichern', back: 'Verwerfen',
    fields: { name: 'Name', code: 'Code', born: 'Geburtsdatum', number: 'Nummer', side: 'Betroffene Seite', hands: 'Hände', preset: 'Kräfte', parameters: 'Reichweite und Finger', warnings: 'Warnungen', plan: 'Plan' },
    hints: { code: 'kein Name', born: 'freiwillig', number: 'freiwillig', warnings: 'vor jeder Sitzung zu sehen' },
    length_m: 'Länge', breadth_m: 'Breite', measure: 'Länge: Handgelenksfalte bis Spitze des Mittelfingers. Breite: über die Knöchel, ohne Daumen.', handImage: '{side}, {length} mm lang, {breadth} mm breit', sideFirst: 'Wählen Sie zuerst die betroffene Seite.',
    reach: 'Reichweite und Finger', kept: 'Das wurde früher geschrieben und ist noch nicht gespeichert.', stays: 'Was Sie geschrieben haben, bleibt hier.', noName: 'Bitte geben Sie einen Namen ein.', bornLater: 'Dieser Tag war noch nicht.', noSide: 'Bitte wählen Sie eine Seite.',
    both: { title: 'Von jemand anderem geändert', words: 'Diese Angaben wurden an einem anderen Bildschirm gespeichert, während Sie schrieben.', yours: 'Ihre', now: 'Dort gespeichert', mine: 'Meine speichern', theirs: 'Die anderen nehmen' },
  },
  patient: {
    patient: 'Person', reading: 'Wird gelesen …', failed: 'Seit {at} nicht gelesen. Es wird von selbst weiter versucht.', asOf: 'Stand von {at}.', visitCount: '{n} Sitzungen', oneVisit: '1 Sitzung', lastOn: 'zuletzt {day}', noVisit: 'noch keine Sitzung',
    progress: 'Verlauf', progressSince: 'Verlauf seit {day}', noProgress: 'Nach zwei Sitzungen stehen hier Kurven.', noClaim: 'Werte wie gemessen; keiner ist ein Urteil.', visits: 'Sitzungen', noVisits: 'Noch keine Sitzungen.', csv: 'Als CSV speichern', print: 'Verlauf drucken', all: 'Alle {n} zeigen', newest: 'Nur die neusten',
    active: 'aktiv', painWords: 'Schmerz vorher {before}, nachher {after}', nothingDone: 'Nichts gemacht.', look: 'Ansehen', move: 'Verschieben', open: 'offen', unfinished: 'nicht beendet', noShow: 'nicht gekommen', helped: '{share} % geholfen', notByPerson: 'nicht von einer Person bewegt', waiting: 'wird gemessen', failedTrial: 'nicht gemessen: {why}', partly: 'aus einem Teil: Die Aufnahme ist nicht ganz', noRecording: 'keine Aufnahme',
    replay: 'Wiedergabe', report: 'Bericht', compare: 'Vergleich', notes: 'Notizen', person: 'Person', edit: 'Ändern', born: 'Geboren', number: 'Nummer', hand: 'Grösse, {side}', preset: 'Kräfte',
    more: 'Fehler und Seltenes', noShowNote: 'Heute nicht gekommen', noShowYes: 'Vermerken', moveTitle: 'Wem gehört die Sitzung vom {day}, {at}?', moved: 'Die Sitzung gehört jetzt zu {name}, {code}.', moveYes: 'Verschieben zu {name}, {code}', remove: 'Person löschen', removeYes: '{name} endgültig löschen',
    merge: { title: 'Doppelte vereinen', which: 'Wer ist doppelt zu {name}, {code}?', yes: 'Vereinen: {name}, {code} wird entfernt, die Sitzungen beider stehen hier', done: '{name}, {code} wurde mit dieser Person vereint.' },
    erase: { title: 'Alles löschen', words: 'Sitzungen, Notizen und Aufnahmen werden endgültig gelöscht, in Sicherungen innert 30 Tagen.', code: 'Schreiben Sie den Code {code}', wrong: 'Das ist ein anderer Code.', press: 'Alles löschen', done: 'Gelöscht. Die letzte Sicherung, die die Person kennt, ist in 30 Tagen weg.' },
  },
  notes: {
    write: 'Notiz schreiben. Sie wird laufend behalten.', done: 'Notiz fertig', none: 'Noch keine Notizen.', states: { empty: '', typing: 'hier behalten', saved: 'gespeichert', waits: 'hier behalten, gespeichert sobald die Akten antworten' },
    kinds: { tired: 'Müde', spasm: 'Spasmus', cue: 'Hinweis gegeben', hands_on: 'Von Hand geholfen', next: 'Nächstes Mal', reason: 'Warum nichts gemacht wurde' },
  },
  pain: { unasked: 'nicht gefragt', before: 'Schmerz vorher', after: 'Schmerz jetzt', notAsked: 'Nicht gefragt', of: 'Schmerz {n} von 10' },
  today: { title: 'Heute', from: 'Wie am {day}', fromPlan: 'Nach dem Plan', begin: 'Sitzung {n} beginnen', goOn: 'Sitzung weiterführen', preparing: 'Die Hand wird geprüft und geprobt, höchstens 20 s.', openSince: 'Offen seit {at}, begonnen von {who}.', otherOpen: 'Zur offenen Sitzung', side: 'Welche Hand heute?', change: 'Plan ändern', ready: 'Plan ist fertig', noPlan: 'Der Plan ist leer. Fügen Sie eine Übung hinzu.', notNow: 'Solange die Akten nicht antworten, kann hier keine Sitzung beginnen. Eine Sitzung ohne Akten geht, mit den sanften Werten.' },
  visit: {
    title: 'Sitzung', plan: 'Plan', noPatient: 'Ohne Person', gentle: 'sanfte Werte', hiddenName: 'Name ausgeblendet', recorded: '● Aufnahme', unrecorded: 'Nicht aufgezeichnet', itemOf: '{n} von {m}', active: 'aktiv: {item} von {of} min, Sitzung {all}', inProgress: 'jetzt', done: 'gemacht', setUp: 'Einrichten',
    next: 'Weiter im Plan', nextIs: 'Weiter: {name}', end: 'Sitzung beenden', stop: 'Sanft anhalten', marks: 'Mit einer Berührung notieren', noteTitle: 'Notizen', pain: 'Schmerz', another: 'Eine andere Sitzung ist offen.', over: 'Diese Sitzung ist zu Ende.', endedElsewhere: 'Diese Sitzung wurde an einem anderen Bildschirm beendet, {at}.',
    whichHand: 'Welche Hand ist im Gerät?', whichHandMore: 'Schauen Sie hin, dann drücken Sie. Danach lässt sich starten.', wrongSide: 'Diese Sitzung ist für: {side}. Stellen Sie das Gerät um, oder beenden Sie die Sitzung und beginnen Sie eine für die andere Hand.',
    notSetUp: 'Das Gerät hat die Werte dieser Sitzung nicht. Drücken Sie «Einrichten» neben einer Übung.', doesNotStop: 'Es hat nicht angehalten. Drücken Sie den Not-Halt.', staysAsItIs: 'Die Übung bleibt, wie sie ist.',
  },
  end: {
    title: 'Ende der Sitzung', doneTitle: 'Gemacht', nothing: 'In dieser Sitzung wurde nichts gemacht.', notDone: 'nicht gemacht', of: '{done} von {planned}', result: 'Ergebnis', now: 'Heute', last: '{day}', lastNone: 'vorher', noResults: 'Keine Ergebnisse.',
    next: 'Wie es weitergeht', reason: 'Warum nichts gemacht wurde', finish: 'Sitzung abschliessen', unfinished: 'Offen lassen', back: 'Zurück zur Übung',
    card: { title: 'Ihr Training heute', trained: 'Sie haben {min} trainiert.', next: 'Nächstes Mal:', nextPatient: 'Nächste Person', toPatient: 'Sitzung ansehen', print: 'Karte drucken' },
  },
  sheet: { back: 'Zurück zu {name}', print: 'Drucken', nothing: 'Noch nichts zu drucken.', progress: 'Verlauf', visit: 'Sitzung vom', day: 'Tag', hand: 'Hand', done: 'Gemacht', active: 'Aktiv', pain: 'Schmerz vorher → nachher' },
  settings: {
    title: 'Einstellungen', people: 'Wer hier arbeitet', newPerson: 'Jemand Neues', name: 'Name', add: 'Hinzufügen', backupProblem: 'Sie misslang: {why}', backup: 'Sicherung', noFolder: 'Kein Ordner für Sicherungen. Starten Sie das Programm mit einem.', noBackup: 'Noch keine Sicherung in {folder}.', lastBackup: 'Letzte Sicherung: {day}, {at}, in {folder}.',
    export: 'Export', exportWords: 'Alle Personen nach Code, ohne Namen.', csvAll: 'Als CSV speichern', leaving: 'Ende des Tages', lockWords: 'Verschlossen brauchen die Akten wieder das Kennwort.', signOut: 'Abmelden', lock: 'Akten verschliessen',
  },
};
