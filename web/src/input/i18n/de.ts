import type { InputTexts } from './en';

export const de: InputTexts = {
  ways: { keys: 'Tasten', mouse: 'Maus', touch: 'Berühren', gamepad: 'Gamepad', webcam: 'Kamera' },
  help: {
    keys: [
      { keys: ['↑', '↓', 'W', 'S'], does: 'von Ihnen weg, zu Ihnen hin' },
      { keys: ['←', '→', 'A', 'D'], does: 'links, rechts' },
      { keys: ['R', 'F', 'Bild ↑', 'Bild ↓'], does: 'hinauf, hinunter' },
      { keys: ['Leertaste'], does: 'halten: drücken, loslassen: öffnen' },
    ],
    mouse: [
      { keys: ['Bewegen'], does: 'links, rechts, hinauf, hinunter' },
      { keys: ['Rad'], does: 'von Ihnen weg, zu Ihnen hin' },
      { keys: ['Linke Taste'], does: 'halten: drücken, loslassen: öffnen' },
    ],
    touch: [
      { keys: ['Ziehen'], does: 'links, rechts; hinauf heisst von Ihnen weg' },
      { keys: ['Zweiter Finger', 'Drücken'], does: 'halten: drücken, loslassen: öffnen' },
      { keys: ['Höher', 'Tiefer'], does: 'hinauf, hinunter' },
    ],
    gamepad: [
      { keys: ['Linker Stick'], does: 'links, rechts, weg, zu Ihnen hin' },
      { keys: ['Rechter Stick'], does: 'hinauf, hinunter' },
      { keys: ['Trigger', 'A'], does: 'drücken, so weit Sie ziehen' },
    ],
    webcam: [
      { keys: ['Hand'], does: 'vor der Kamera bewegen; näher zur Kamera heisst von Ihnen weg' },
      { keys: ['Faust'], does: 'Hand schliessen: drücken, Hand öffnen: loslassen' },
    ],
  },
  oneButton: { keys: 'Leertaste', mouse: 'Klick', touch: 'Tippen', gamepad: 'A' },
  letGo: { keys: 'Leertaste loslassen', mouse: 'Maustaste loslassen', touch: 'Finger abheben, der drückt', gamepad: 'Trigger loslassen', webcam: 'Hand öffnen' },
  hold: { keys: 'Zum Drücken hier die Leertaste halten', mouse: 'Zum Drücken hier die Maustaste halten', touch: 'Zum Drücken hier den Knopf halten', gamepad: 'Zum Drücken hier den Trigger halten', webcam: 'Zum Drücken hier eine Faust machen' },
  touch: { squeeze: 'Drücken', higher: 'Höher', lower: 'Tiefer' },
  webcam: {
    insecure: 'Der Browser gibt hier keine Kamera frei. Öffnen Sie die Seite über https oder auf diesem Computer selbst.',
    refused: 'Die Kamera wurde abgelehnt. Erlauben Sie sie in der Adresszeile des Browsers und versuchen Sie es noch einmal.',
    absent: 'Es wurde keine Kamera gefunden. Schliessen Sie eine an, oder spielen Sie mit Tasten oder Maus.',
    busy: 'Die Kamera ist nicht gestartet. Vielleicht braucht sie ein anderes Programm.',
    model: 'Die Handerkennung konnte nicht geladen werden. Spielen Sie mit Tasten oder Maus.',
    ended: 'Die Kamera ist aus. Spielen Sie mit Tasten oder Maus, oder starten Sie sie neu.',
  },
  camera: {
    ask: 'Erlauben Sie die Kamera',
    askMore: 'Ihr Browser fragt danach. Das Bild bleibt auf diesem Computer.',
    load: 'Einen Moment …',
    loadMore: 'Die Kamera wird vorbereitet.',
    frame: 'Halten Sie die Hand ins Bild',
    frameMore: 'Offen und ruhig. Danach führt sie die Hand in der Übung.',
    noHand: 'Keine Hand zu sehen',
    noHandMore: 'Halten Sie Ihre offene Hand vor die Kamera.',
    otherWay: 'Anders spielen',
    again: 'Kamera starten',
  },
};
