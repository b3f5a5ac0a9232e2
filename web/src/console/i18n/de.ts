import type { ConsoleTexts } from './en';

export const de: ConsoleTexts = {
  title: 'Wholehand: Konsole',
  hand: { right: 'rechts', left: 'links' },
  session: 'Sitzung {n}',
  level: 'Stufe {n}',
  levelOf: 'Stufe {n} von {m}',
  drinkOf: 'Getränk {n} von {m}',
  exercises: { 'cocktail-bar': 'Cocktailbar', 'free-grasping': 'Freies Greifen' },
  hands: {
    'adult-median-right': 'Median, rechts', 'adult-median-left': 'Median, links',
    'woman-p05-right': 'Frau P5, rechts', 'woman-p50-right': 'Frau P50, rechts', 'woman-p95-right': 'Frau P95, rechts',
    'man-p05-right': 'Mann P5, rechts', 'man-p50-right': 'Mann P50, rechts', 'man-p95-right': 'Mann P95, rechts',
  },
  patients: {
    'relaxed-adult': 'Entspannte Person', 'stiff-adult': 'Steife Person', 'no-arm': 'Ohne Arm', tremor: 'Zittern', spastic: 'Spastik',
    releases: 'Lässt los', slams: 'Schlägt', fights: 'Wehrt sich', 'enslaved-fingers': 'Finger hängen zusammen', 'spastic-fist': 'Spastische Faust',
    'pill-rolling': 'Pillendrehen', 'holds-a-ball': 'Hält einen Ball',
  },
  noExercise: 'Keine Übung',

  states: {
    connecting: 'Verbindet', lost: 'Verbindung weg', disarmed: 'Gesperrt', rendering: 'Läuft',
    paused: 'Pause', stopping: 'Hält an', stopped: 'Angehalten', faulted: 'Störung',
    armed: 'Scharf',
  },
  pill: {
    connecting: 'Wartet auf das Programm', lost: 'Nichts hier ist aktuell', disarmed: 'Nichts drückt',
    rendering: 'Alle Grenzen eingehalten', limited: 'Kraft an der Grenze', paused: 'Die Übung wartet',
    stopping: 'Auf dem Weg zu neutral', stopped: 'In Ruhe', faulted: 'In Ruhe',
  },

  theme: 'Dunkel oder hell',
  language: 'Sprache',
  tables: 'Tabellen statt Kurven',
  pause: 'Pause', resume: 'Weiter', arm: 'Starten', armAgain: 'Neu starten', stop: 'Sanft anhalten',
  emergency: 'Not-Halt',
  space: 'Leertaste', esc: 'Esc',

  plots: {
    hand: 'Kraft, Hand', arm: 'Kraft, Arm', axis: 'Koordinate', ratios: 'φ und α',
    device: 'Gerät', avatar: 'Avatar', limit: 'Grenze', now: 'jetzt', axisChoice: 'Achse',
    image: '{name}: die letzten 10 Sekunden. Zahlen mit «Tabellen».',
    series: 'Kurve', latest: 'Jetzt', least: 'Kleinster', most: 'Grösster',
    tableCaption: '{name}, letzte 10 Sekunden', fault: 'Störung', stop: 'Halt',
  },
  axes: {
    x: 'x', y: 'y', z: 'z', roll: 'Rollen', pitch: 'Nicken', yaw: 'Gieren',
    finger_flexion: 'Finger', thumb_circumduction: 'Drehung', thumb_flexion: 'Daumen',
  },
  axesLong: {
    x: 'x, weg', y: 'y, links', z: 'z, hinauf', roll: 'Rollen', pitch: 'Nicken', yaw: 'Gieren',
    finger_flexion: 'Finger', thumb_circumduction: 'Daumen, Drehung', thumb_flexion: 'Daumen, Beugung',
  },
  axesKey: {
    x: 'x', y: 'y', z: 'z', roll: 'ro', pitch: 'ni', yaw: 'gi',
    finger_flexion: 'f', thumb_circumduction: 'c', thumb_flexion: 't',
  },
  phases: { bump: 'berührt', engaged: 'Griff, Wand blendet ein', pour: 'giesst', release: 'lässt los' },

  view: {
    title: '3D-Ansicht', skin: 'Haut', colliders: 'Kollider', choice: 'Hand gezeichnet als',
    none: 'Keine 3D-Ansicht: Dieser Browser hat kein WebGL. Alles andere geht.',
    loading: 'Die 3D-Ansicht wird aufgebaut …',
  },
  pouring: '{liquid}, {a} / {b} ml',

  safety: {
    title: 'Sicherheit', peaks: 'Spitzen der letzten 10 s', state: 'Zustand',
    noFault: 'Keine Störung', cause: 'Ursache: {what}',
    nothingYet: 'Seit dem Start ist nichts geschehen.',
    lastNotice: '{time}: {what}',
    disarmed: 'Nicht gestartet', disarmedWhat: 'Das Gerät drückt nicht. Starten Sie, wenn die Person bereit ist.',
    stopping: 'Die Kraft geht zu neutral', stoppingWhat: 'Das dauert höchstens eine Zehntelsekunde. Der Arm wird getragen.',
    stopped: 'Auf Wunsch angehalten', stoppedWhat: 'Die Kraft ist neutral, der Arm wird getragen. Neu starten, wenn alle bereit sind.',
    faultedWhat: 'Die Kraft ging innert 0,1 s zu neutral. Der Arm wird getragen.',
    armed: 'Scharf gestellt', armedWhat: 'Die Kraft wird eingeblendet.', emergency: 'Not-Halt wurde gedrückt', beyond: '{value}, Grenze {limit}',
    lost: 'Keine Verbindung zum Programm',
    lostWhat: 'Wenn das Programm läuft, klingt die Kraft der Übung von selbst ab. Die Zahlen hier sind von vorher.',
    fingers: 'Finger', thumb: 'Daumen', arm: 'Arm x y z', speed: 'Tempo Arm', of: '{a} von {b}',
  },
  advice: {
    'device read failed': 'Kabel und Strom des Geräts prüfen, dann neu starten.',
    'device write failed': 'Kabel und Strom des Geräts prüfen, dann neu starten.',
    'non-finite device position': 'Kabel und Strom des Geräts prüfen, dann neu starten.',
    'non-finite effort': 'Die Übung neu laden, dann starten. Kommt es wieder, dem sagen, der das Programm betreut.',
    'non-finite state': 'Die Übung neu laden, dann starten. Kommt es wieder, dem sagen, der das Programm betreut.',
    'physics step failed': 'Die Übung neu laden, dann starten. Kommt es wieder, dem sagen, der das Programm betreut.',
    'singular reduced inertia': 'Die Übung neu laden, dann starten. Kommt es wieder, dem sagen, der das Programm betreut.',
    'bodies exploded': 'Die Übung neu laden, dann starten. Kommt es wieder, dem sagen, der das Programm betreut.',
    'speed limit exceeded': 'Schauen, dass die Person ruhig und der Arm frei ist, dann neu starten.',
    'workspace left': 'Die Hand zurück in die Mitte führen, dann neu starten.',
    'encoder jumped': 'Mit diesem Gerät nicht weitermachen, bis es geprüft ist.',
    'encoder stuck': 'Mit diesem Gerät nicht weitermachen, bis es geprüft ist.',
    'drive fault': 'Den Code des Antriebs im Handbuch seines Herstellers nachsehen, quittieren, dann neu starten.',
    'enable lost': 'Die Stopptaste des Geräts lösen oder seine Freigabe drücken, dann neu starten.',
    'stale sample': 'Kabel und Strom des Geräts prüfen, dann neu starten.',
    'late ticks in a row': 'Der Rechner war zu langsam: andere Programme beenden, dann neu starten.',
    'gap too long': 'Der Rechner war zu langsam: andere Programme beenden, dann neu starten.',
    other: 'Neu starten, wenn die Ursache weg ist.',
  },

  timing: {
    title: 'Zeit pro Takt', missed: '{n} verpasst von {m}', deadline: 'Frist {t}', slower: 'Takte, die länger dauerten',
    image: 'Wie viele Takte länger dauerten als eine Zeit, in Mikrosekunden: die Hälfte {p50}, einer von hundert {p99}, einer von tausend {p999}, der langsamste {max}.',
    max: 'max, µs', dropped: '{n} Einträge verworfen',
  },

  setup: {
    title: 'Sitzung', exercise: 'Übung', level: 'Stufe', hand: 'Hand', load: 'Laden', steering: 'Wer spielt',
    virtual: 'Virtuelle Person', person: 'Person', next: 'Weiter', restart: 'Von vorn',
    yours: 'Steuerung: hier', free: 'Steuerung: frei', others: 'Steuerung: belegt',
    take: 'Steuerung übernehmen', takeShort: 'Nehmen', giveBack: 'Abgeben',
  },

  parameters: {
    title: 'Parameter', groups: { 0: 'Person', 1: 'Hand', 2: 'Übung' },
    ramp: 'Rampe → {v}', range: '{name}, {lo} bis {hi} {unit}', none: 'Hier ist nichts einzustellen.',
    notANumber: 'Bitte eine Zahl von {lo} bis {hi} eingeben.', refused: 'Nicht geändert: {reason}',
    names: {
      effort_limit_hand_tip_n: 'Kraftgrenze, Hand',
      effort_limit_arm_n: 'Kraftgrenze, Arm',
      damping_full_n: 'Dämpfung, voll ab',
      damping_decay_s: 'Dämpfung klingt ab in',
      wall_stiffness_ratio: 'Steifigkeit der Wand',
      wall_damping_ratio: 'Dämpfung der Wand',
      lead_in_m: 'Wand vor dem Kontakt',
      squeeze_threshold_ratio: 'Nötiger Druck',
    },
  },

  recordings: {
    title: 'Aufzeichnungen', none: 'Noch keine Aufzeichnungen.', failed: 'Die Liste liess sich nicht lesen. Neuer Versuch folgt.',
    report: 'Bericht', download: 'Laden', reportOf: 'Bericht von {name}', downloadOf: 'Laden: {name}', now: 'Aufnahme',
  },

  notices: {
    lost: 'Verbindung unterbrochen. Die Zahlen sind von vorher.', lostMore: 'Wenn das Programm läuft, klingt die Kraft der Übung von selbst ab.',
    unconfirmed: 'Stopp nicht bestätigt: roten Knopf drücken.', unconfirmedMore: 'Diese Seite sendet den Stopp weiter.',
    left: 'Sie haben diese Seite verlassen: Die Steuerung wurde zurückgegeben, und die Kraft der Übung bleibt weg, bis jemand sie übernimmt.',
    unheard: 'Das Programm hat diese Seite nicht gehört: Die Steuerung wurde zurückgegeben, und die Kraft der Übung bleibt weg, bis jemand sie übernimmt.',
    hardware: 'Der rote Knopf am Roboter wirkt immer.', retry: 'Jetzt versuchen', attempts: 'Versuch {n} …',
    held: 'Ein anderes Gerät steuert: Sie sehen zu. Der Not-Halt wirkt immer.',
    version: 'Das Programm spricht Version {theirs} der Meldungen, diese Seite Version {ours}. Laden Sie die Seite neu.',
    refused: '{what} wurde abgelehnt: {reason}', close: 'Schliessen',
  },
};
