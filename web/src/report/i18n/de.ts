import type { ReportTexts } from './en';

export const de: ReportTexts = {
  title: 'Bericht: {name}', report: 'Bericht', replay: 'Noch einmal ansehen', print: 'Drucken', therapy: 'Therapie', engineering: 'Technik',
  pageOf: 'Seite {n} von {m}', program: 'Programm {version}', notDiagnosis: 'Keine Diagnose. Jede Zahl stammt aus der Aufzeichnung.',
  reading: 'Der Bericht wird gelesen …', none: 'keine', time: 'Zeit', seconds: 's',
  facts: { patient: 'Patient', hand: 'Hand', device: 'Gerät', exercise: 'Übung', date: 'Datum', length: 'Dauer', file: 'Datei', simulated: 'simuliert', noExercise: 'Keine Übung', unknown: 'nicht angegeben' },
  tiles: {
    levels: 'Stufen beendet', of: 'von {n}', reach: 'bis zum Greifen, im Mittel', grip: 'Griffkraft, im Mittel', steadiness: 'Griff schwankt um',
    touched: 'Gegenstände berührt', held: 'insgesamt gehalten', force: 'grösste Kontaktkraft', effort: 'grösste Kraft, {axis}',
  },
  whose: {
    who: ['niemand', 'die Person', 'der virtuelle Patient', 'eine abgespielte Bewegung'], moved: '{who} hatte die Hand {n} % der Zeit ({time})',
    active: 'Aktiv: {time}', activeHelped: 'davon {time} mit etwas Hilfe', led: 'geführt: {time}',
    helps: ['', 'mit voller Hilfe', 'mit etwas Hilfe', 'ohne Hilfe'], helped: 'Von der Person: {helps}.',
    person: 'von der Person', shared: 'geteilt, zu {n} % von der Person', shown: ['niemand bewegte', 'von der Person', 'gezeigt vom virtuellen Patienten', 'gezeigt von einer abgespielten Bewegung'],
    unknown: 'Diese Aufnahme sagt nicht, wer die Hand bewegte: Sie ist älter, und ihre Hand war simuliert.',
    things: { band_held: 'Bereiche', level_done: 'Stufen', reach: 'Griffwege', grip: 'Griffe' } as Record<string, string>,
    apart: '{what}: {n}', sharedCount: '{n} geteilt', othersCount: '{n} nicht von der Person', touches: 'Berührungen: {n}', notCounted: 'Nicht gezählt: {what}.',
    rule: 'Ein Teil der Übung, eine Stufe, ein Griffweg, ein Griff oder eine Berührung zählt, wenn die Person die Hand in jedem Takt vom ersten bis zum letzten bewegte; was zum Teil jemand anders bewegte, ist geteilt und in keiner Summe.',
  },
  before: { was: 'vorher: {x}', better: 'besser', compared: 'Vorher: {name}, {date}.', other: 'Anders war: {what}.', not: 'Nicht verglichen: {what}.', nothing: 'Keine der Zahlen ist vergleichbar.' },
  steadinessNote: 'Griff: mindestens 1 N für mindestens 1 s. Er schwankt um seine Standardabweichung, als Anteil des Mittels; die ersten und letzten 0,25 s jedes Griffs zählen nicht.',
  happened: {
    title: 'Stopps und Störungen', emergency_stop: 'Not-Halt', stop: 'Stopp', fault: 'Störung', controls_lost: 'Steuerung verloren', missing: 'Fehlende Takte', missed: 'Übersprungene Perioden', limited: 'Kraft an der Grenze',
    at: 'bei {times}', more: '{times} und {n} weitere', ticks: '{n} Takte', lost: '{n} Takte, {s} s', unreadable: 'Ab {time} ist die Datei nicht lesbar.', unreadableEnd: 'Das Ende der Datei ist nicht lesbar.',
    written: 'Die Aufzeichnung wurde noch geschrieben.', brokenOff: 'Die Sitzung wurde abgebrochen: Die Aufnahme hat kein Ende, weil Programm oder Rechner ausfielen oder die Platte voll war.', truncated: 'Es geschah mehr, als diese Seite fasst.',
  },
  picture: { caption: 'Stärkster Kontakt: {n} N bei {time}', last: 'Am Ende, {time}', none: 'Kein Bild: Dieser Browser hat kein WebGL. Alles andere geht.', noScene: 'Kein Bild: {why}', drawing: 'Das Bild wird gezeichnet …' },
  bodies: { title: 'Was gehalten wurde', body: 'Gegenstand', first: 'Zuerst bei', touches: 'Berührungen', longest: 'Längste Berührung, s', held: 'Gehalten, s', force: 'Kraft, N', way: 'Bewegt, cm', nothing: 'Keine der Zahlen ist vergleichbar.', noBodies: 'Es gab nichts zu berühren.', more: 'und {n} weitere', note: 'Gehalten: Finger auf einer Seite, Daumen oder Handfläche auf der anderen, oder ein Griff, den die Übung zählt.' },
  charts: {
    grip: 'Griffkraft', goal: 'verlangt', contact: 'Kontaktkraft', limits: 'Geltende Kraftgrenzen', effortHand: 'Kraft, Hand', effortArm: 'Kraft, Arm', phi: 'Adaptive Dämpfung φ', alpha: 'Wand der Übung α',
    handPosition: 'Stellung, Hand', armPosition: 'Stellung, Arm', palm: 'Handfläche zum nächsten Gegenstand', count: 'Kontaktpunkte', times: 'Zeit je Takt', timesCpu: 'Rechenzeit je Takt', ticks: 'Takte', click: 'Klick in ein Diagramm: diesen Augenblick ansehen.', missing: 'Blassrot: fehlt.', touchesLeftOut: 'Nicht schattiert: {n} weitere Berührungen; die Zahlen enthalten sie.', limitsThinned: 'Änderungen einer Grenze innerhalb von {s} s sind als eine gezeichnet.', touches: 'Getönt: Die Hand berührt etwas.',
  },
  compared: {
    title: 'Unterschiede gespürt', threshold: 'Drei von vier Unterschieden von {n} % werden gespürt ({interval}).', between: '95 %: {a} bis {b} %', below: '95 %: unter {n} %', above: '95 %: über {n} %', atLimit: 'Das ist die Grenze des Geräts.',
    notEnough: 'Nicht genug für eine Schwelle: {why}.', answers: 'Antworten: {n}{by}.', other: 'Wer nur die Tiefe des Drucks vergleicht, hat in {n} % recht.', notPersons: 'Nicht von einer Person: jemand anderes bewegte die Hand.',
    why: { answers: 'es fehlen {n} Antworten', guesses: 'die Antworten folgen den Unterschieden nicht', one_answer: 'fast alle Antworten sind gleich', compares_other: 'die Tiefe des Drucks erklärt die Antworten besser', misses_catches: 'grosse Unterschiede wurden verpasst', beyond_range: 'mit diesen Unterschieden sind nur Schwellen bis {most} % bestimmbar' } as Record<string, string>,
    by: { squeeze: '{n} durch Drücken', player: '{n} mit Taste oder Berührung', therapist: '{n} vom Therapeuten gesagt', earlier: '{n} vor einer Pause' } as Record<string, string>,
    chart: '«Die zweite war mehr», je nach Unterschied', fitted: 'angepasst', points: 'Antworten',
  },
  stages: {
    title: 'Rechenzeit eines Takts, µs', stage: 'Stufe', max: 'max.', whole: 'ganzer Takt',
    names: { device_read: 'Gerät lesen', observe: 'beobachten', dynamics: 'Dynamik', control: 'Regelung', exercise: 'Übung', safety: 'Sicherheit', device_write: 'Gerät schreiben', physics_step: 'Physikschritt', contacts: 'Kontakte' },
  },
  faults: { title: 'Störungen nach Takten', fault: 'Störung', ticks: 'Takte', axis: 'Meist an' },
  settings: {
    title: 'Einstellungen', scene: 'Szene', rendering: 'Rendering', engine: 'Physik', rate: 'Rate', simulatedClock: 'simulierte Uhr', realTime: 'Echtzeit', gains: 'Verstärkungen', accepted: 'zugelassen', uncertified: 'NICHT zertifiziert', paper: 'Gesetz der Veröffentlichung',
    passport: 'Gerätepass', seed: 'Startwert', deadlines: 'Fristen versäumt', damped: 'Dämpfung φ über 0,5', share: '{n} % der Zeit', coupling: 'Grösster Kopplungsfehler', work: 'Arbeit des Geräts', limits: 'Grenzen des Geräts',
  },
  problems: {
    template: 'Diese Seite enthält keine Aufzeichnung. Einen Bericht macht: wholehand replay --report bericht.html AUFZEICHNUNG.h5', old: 'Dieser Browser ist zu alt für diese Seite. Bitte mit einem Browser ab 2023 öffnen.',
    broken: 'Die Daten dieser Seite sind nicht lesbar. Bitte den Bericht neu machen.', says: 'Grund:',
  },
};
