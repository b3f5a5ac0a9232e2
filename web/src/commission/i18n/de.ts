import type { CommissionTexts } from './en';

export const de: CommissionTexts = {
  title: 'Inbetriebnahme', daily: 'Tägliche Prüfung', by: '{device}, Seriennummer {serial}, durch {operator}',
  rule: 'Niemand darf am Gerät befestigt sein. Stehen Sie so, dass Sie seinen Not-Halt erreichen.',
  stop: 'Stopp', language: 'Sprache', theme: 'Dunkel oder hell', steps: 'Schritte', to: 'bis', yes: 'Ja', no: 'Nein', go: 'Weiter', done: 'Fertig',
  states: ['noch nicht', 'jetzt', 'erledigt', 'nicht bestanden'],
  step: {
    identify: 'Welches Gerät', home: 'Marke und Nullpunkt', signs: 'Vorzeichen', 'scale-and-travel': 'Massstab und Weg', gravity: 'Schwerkraft',
    'mass-friction-delay': 'Masse, Reibung, Verzögerung', 'known-weight': 'Bekannte Kraft', watchdog: 'Watchdog', 'emergency-stop': 'Not-Halt',
    'range-stops': 'Ganzer Bereich', 'effort-limit': 'Kraftgrenze', passport: 'Pass',
  },
  finding: {
    'carried-by': 'getragen von', 'moves-at-plus': 'bewegt sich in + bei', 'moves-at-minus': 'bewegt sich in − bei', travel: 'Weg', mass: 'Masse',
    damping: 'Dämpfung', 'dry-friction': 'Trockenreibung', delay: 'Verzögerung', 'known-force': 'bekannte Kraft', 'carried-with': 'getragen mit', 'let-go-after': 'lässt los nach',
    'responds-up-to': 'antwortet wie gemessen bis', 'drive-lag': 'Trägheit des Antriebs',
  },
  away: { x: 'von sich weg', y: 'nach links', z: 'nach oben' },
  axis: 'Achse {name}',
  plus: 'in die Richtung + (ein Finger: schliessen)',
  ask: {
    device: 'Ist das das Gerät mit der Seriennummer {serial}?', deviceMore: 'Treiber {driver}, Firmware {firmware}. Vergleichen Sie das Schild am Gerät.',
    nobody: 'Ist niemand am Gerät befestigt?', nobodyYes: 'Niemand ist befestigt', nobodyNo: 'Doch, jemand', nobodyMore: 'Stellen Sie das Gerät auf seine Marke, wo Sie es jeden Tag hinstellen. Nehmen Sie alle heraus. Ab jetzt kann es sich bewegen.',
    push: '{axis} {way} schieben', pushMore: 'Um etwa ein Zehntel des Bereichs. Lassen Sie die Achse dort stehen.',
    travel: '{axis} von Anschlag zu Anschlag bewegen', travelMore: 'Langsam, von Hand, zum einen Anschlag und dann zum andern. Messen Sie die Strecke.', travelField: 'Strecke',
    force: '{axis} mit bekannter Kraft ziehen', forceMore: 'Gegen die Richtung +, mit einem Gewicht über eine Rolle oder einer Federwaage: {lower} bis {upper} {unit}.', forceField: 'Kraft',
    estop: 'Not-Halt lösen', estopMore: 'Er hat das Gerät abgeschaltet. Lösen Sie ihn, und drücken Sie dann Fertig.',
    next: 'Dieser Schritt ist nicht bestanden', nextMore: 'Beheben Sie es, und wiederholen Sie den Schritt.', repeat: 'Wiederholen: {step}', check: 'Nochmals prüfen', earlier: 'Früheren Schritt wiederholen', end: 'Beenden', noNumber: 'Eine Zahl über 0, ohne Einheit.',
  },
  motion: [
    'Das Gerät kann seinen Nullpunkt selbst anfahren. Das beendet nur sein Not-Halt.', '{axis} wird in beide Richtungen geschoben.', 'Gemessen wird, was {axis} trägt.',
    '{axis} wird durch den Bereich gefahren.', '{axis} wird gemessen.', 'Der Watchdog wird ausgelöst.', 'Drücken Sie den Not-Halt am Gerät, während Sie halten.',
  ],
  hold: 'Halten zum Bewegen', holdMore: 'Mit dem Zeiger oder der Leertaste. Das Gerät bewegt sich, solange Sie halten, und bleibt stehen, wenn Sie loslassen.', held: 'In Bewegung: Loslassen stoppt', ready: 'Nichts bewegt sich, bis Sie halten.',
  lead: 'Von hier aus führen', leadHead: 'Niemand führt', leadMore: 'Eine Konsole führt. Alle andern sehen zu.', watchHead: 'Eine andere Konsole führt', watchMore: 'Sie sehen zu. Stoppen können Sie das Gerät.', takeOver: 'Übernehmen',
  wait: 'Einen Moment', waitMore: 'Das Programm arbeitet. Nichts bewegt sich.', connecting: 'Verbindung wird aufgebaut', lost: 'Verbindung verloren', lostMore: 'Was sich bewegte, wurde kraftlos gemacht. Die Seite verbindet sich von selbst wieder.',
  elsewhere: 'Hier wird kein Gerät in Betrieb genommen', elsewhereMore: 'Starten: wholehand device commission --web',
  finished: 'Der Pass ist geschrieben', finishedDaily: 'Für heute geprüft', finishedMore: 'Aufzeichnung aller Bewegungen: {recording}', needsDaily: 'Er gilt 30 Tage. Prüfen Sie das Gerät jeden Tag vor dem ersten Gebrauch.',
  why: 'Gefunden', remedy: 'Zu tun',
};
