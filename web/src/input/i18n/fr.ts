import type { InputTexts } from './en';

export const fr: InputTexts = {
  ways: { keys: 'Touches', mouse: 'Souris', touch: 'Tactile', gamepad: 'Manette', webcam: 'Caméra' },
  help: {
    keys: [
      { keys: ['↑', '↓', 'W', 'S'], does: 'loin de vous, vers vous' },
      { keys: ['←', '→', 'A', 'D'], does: 'à gauche, à droite' },
      { keys: ['R', 'F', 'Page ↑', 'Page ↓'], does: 'en haut, en bas' },
      { keys: ['Espace'], does: 'maintenir : presser, lâcher : ouvrir' },
    ],
    mouse: [
      { keys: ['Bouger'], does: 'à gauche, à droite, en haut, en bas' },
      { keys: ['Molette'], does: 'loin de vous, vers vous' },
      { keys: ['Bouton gauche'], does: 'maintenir : presser, lâcher : ouvrir' },
    ],
    touch: [
      { keys: ['Glisser'], does: 'à gauche, à droite ; vers le haut : loin de vous' },
      { keys: ['Deuxième doigt', 'Presser'], does: 'maintenir : presser, lâcher : ouvrir' },
      { keys: ['Plus haut', 'Plus bas'], does: 'en haut, en bas' },
    ],
    gamepad: [
      { keys: ['Stick gauche'], does: 'à gauche, à droite, loin, vers vous' },
      { keys: ['Stick droit'], does: 'en haut, en bas' },
      { keys: ['Gâchette', 'A'], does: 'presser, aussi loin que vous tirez' },
    ],
    webcam: [
      { keys: ['Main'], does: 'bougez-la devant la caméra ; plus près de la caméra : loin de vous' },
      { keys: ['Poing'], does: 'fermez la main pour presser, ouvrez-la pour lâcher' },
    ],
  },
  oneButton: { keys: 'Espace', mouse: 'Cliquer', touch: 'Appuyer', gamepad: 'A' },
  letGo: { keys: 'Relâchez la barre d’espace', mouse: 'Relâchez le bouton de la souris', touch: 'Levez le doigt qui presse', gamepad: 'Relâchez la gâchette', webcam: 'Ouvrez la main' },
  hold: { keys: 'Ici, tenez la barre d’espace pour presser', mouse: 'Ici, tenez le bouton pour presser', touch: 'Ici, tenez « Presser » pour presser', gamepad: 'Ici, tenez la gâchette pour presser', webcam: 'Ici, fermez le poing pour presser' },
  touch: { squeeze: 'Presser', higher: 'Plus haut', lower: 'Plus bas' },
  webcam: {
    insecure: 'Le navigateur ne donne pas de caméra ici. Ouvrez cette page par https ou sur cet ordinateur même.',
    refused: 'La caméra a été refusée. Autorisez-la dans la barre d’adresse du navigateur, puis réessayez.',
    absent: 'Aucune caméra trouvée. Branchez-en une, ou jouez avec les touches ou la souris.',
    busy: 'La caméra n’a pas démarré. Un autre programme l’utilise peut-être.',
    model: 'Le suivi de la main n’a pas pu être chargé. Jouez avec les touches ou la souris.',
    ended: 'La caméra s’est arrêtée. Jouez avec les touches ou la souris, ou relancez-la.',
  },
  camera: {
    ask: 'Autorisez la caméra',
    askMore: 'Votre navigateur la demande. L’image reste sur cet ordinateur.',
    load: 'Un instant …',
    loadMore: 'La caméra se prépare.',
    frame: 'Gardez la main dans l’image',
    frameMore: 'Ouverte et immobile. Ensuite, elle dirige la main dans l’exercice.',
    noHand: 'Aucune main visible',
    noHandMore: 'Tenez votre main ouverte devant la caméra.',
    otherWay: 'Jouer autrement',
    again: 'Démarrer la caméra',
  },
};
