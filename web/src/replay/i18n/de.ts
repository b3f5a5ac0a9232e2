import type { ReplayTexts } from './en';

export const de: ReplayTexts = {
  title: '{name}: Wiedergabe', brand: 'Wiedergabe',
  report: 'Bericht', reportOf: 'Bericht zu {name}',
  making: 'Der Bericht wird erstellt … {s} s', makingLine: 'In Arbeit', opening: 'Die Aufzeichnung wird geöffnet …', loading: '{percent} % gelesen',
  sides: { a: 'A', b: 'B' },

  transport: {
    title: 'Abspielen', play: 'Abspielen', pause: 'Anhalten', space: 'Leertaste', back: 'Ein Takt zurück', forward: 'Ein Takt weiter', home: 'Zum Anfang', end: 'Zum Ende',
    earlier: 'Zur Marke davor', later: 'Zur nächsten Marke', speed: 'Tempo', zoomIn: 'Kürzeres Fenster', zoomOut: 'Längeres Fenster', whole: 'Alles',
    tick: 'Takt {n} von {m}', near: 'wird gelesen …', window: 'Fenster {a} bis {b}',
  },
  timeLine: {
    title: 'Zeitleiste', position: '{time}, {tick}', begin: 'Anfang des Fensters', end: 'Ende des Fensters',
    help: 'Pfeile: ein Takt. Mit Umschalt: eine Zehntelsekunde. Bildtasten: Marken. Plus und Minus: das Fenster.',
  },
  plots: {
    image: '{name}, {a} bis {b}. Zahlen mit «Tabellen».', tableCaption: '{name}, im Fenster', latest: 'An der Abspielstelle',
    intention: 'gewollt', parts: 'Kraft, {axis}', sent: 'gesendet', exercise: 'Übung', damping: 'Dämpfung',
    contact: 'Berührung', force: 'Kraft', count: 'Kontakte', palm: 'Handfläche zum Objekt', distance: 'Abstand', duration: 'Zeit pro Takt', took: 'dauerte',
    value: 'Übung', valueOthers: 'Messwerte, für die Technik', valueChoice: 'Wert der Übung', hint: 'Klick: dorthin. Ziehen: vergrössern. Strg und Rad: länger oder kürzer.',
    title: 'Kurven',
  },
  facts: {
    title: 'Aufzeichnung', when: 'Wann', exercise: 'Übung', hand: 'Hand', patient: 'Person', device: 'Gerät', simulated: 'simuliert', length: 'Länge',
    ticks: '{n} Takte', missing: 'Es fehlen', end: 'Ende', ends: { stop: 'durch jemanden', fault: 'durch eine Störung', broken_off: 'abgebrochen: Die Aufnahme hat kein Ende' } as Record<string, string>, program: 'Programm', result: 'Ergebnis', noExercise: 'Keine',
  },
  moments: {
    title: 'Marken', none: 'In diesem Fenster ist nichts geschehen.', more: '{n} von {m}, um die Abspielstelle. Ein kürzeres Fenster zeigt weniger.', gap: '{n} Takte fehlen',
    kinds: {
      stop: 'Stopp', emergency_stop: 'Not-Halt', fault: 'Störung', controls_lost: 'Steuerung verloren', armed: 'Scharf gestellt', neutral: 'In Neutralstellung',
    },
    short: { stop: 'Stopp', emergency_stop: 'Not-Halt', fault: 'Störung', controls_lost: 'Steuerung verloren', armed: 'scharf', neutral: 'neutral', gap: 'Lücke' },
    events: {
      approached: 'Nahe an einem Objekt', touched: 'Berührt', engaged: 'Gegriffen', disengaged: 'Losgelassen',
      level_done: 'Stufe fertig', paused: 'Pause', resumed: 'Weiter', restarted: 'Neu begonnen',
    },
  },
  notices: {
    differs: 'Unterschied zu A: {what}.', axesOfOne: 'Achsen nur einer Aufzeichnung: {axes}.',
    failed: '{name} wird nicht gezeigt. {why}',
    written: 'Diese Aufzeichnung wird noch geschrieben.', readOn: 'Weiterlesen',
    damaged: 'Ab {time} ist die Datei nicht lesbar.', damagedEnd: 'Das Ende der Datei ist nicht lesbar.', holes: '{n} Takte fehlen: auf der Zeitleiste bezeichnet.',
    noPicture: 'Kein Bild: {why}', noPictureAtAll: 'Kein Bild: Die Szene lässt sich aus dieser Datei nicht aufbauen.', noExercise: 'Ohne Übung aufgezeichnet.',
    gone: 'Das Programm antwortet nicht. Gelesenes bleibt; der Rest kommt, wenn es wieder da ist.', retry: 'Jetzt versuchen',
    piece: 'Ein Teil der Aufzeichnung ist nicht lesbar: {why}', empty: 'Die Aufzeichnung hat keine Takte.',
  },
  problems: {
    unknown: 'Es gibt keine Aufzeichnung dieses Namens.', denied: 'Das Programm verlangt ein Token. Öffnen Sie die Wiedergabe aus der Konsole.',
    unreadable: 'Diese Aufzeichnung lässt sich nicht öffnen.', gone: 'Das Programm antwortet nicht.', nonsense: 'Das Programm antwortet etwas, das diese Seite nicht versteht. Laden Sie die Seite neu; hilft das nicht, erneuern Sie das Programm.',
    none: 'Die Adresse nennt keine Aufzeichnung: /replay?recording=NAME. Die Konsole führt sie auf.', says: 'Das Programm sagt:', again: 'Nochmals versuchen', console: 'Zur Konsole',
  },
};
