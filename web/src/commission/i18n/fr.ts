import type { CommissionTexts } from './en';

export const fr: CommissionTexts = {
  title: 'Mise en service', daily: 'Contrôle du jour', by: '{device}, numéro de série {serial}, par {operator}',
  rule: 'Personne ne doit être attaché à l’appareil. Restez à portée de son arrêt d’urgence.',
  stop: 'Arrêt', language: 'Langue', theme: 'Sombre ou clair', steps: 'Étapes', to: 'à', yes: 'Oui', no: 'Non', go: 'Continuer', done: 'C’est fait',
  states: ['à faire', 'en cours', 'fait', 'échec'],
  step: {
    identify: 'Quel appareil', home: 'Repère et zéro', signs: 'Signes', 'scale-and-travel': 'Échelle et course', gravity: 'Gravité',
    'mass-friction-delay': 'Masse, frottement, retard', 'known-weight': 'Force connue', watchdog: 'Chien de garde', 'emergency-stop': 'Arrêt d’urgence',
    'range-stops': 'Toute la course', 'effort-limit': 'Limite d’effort', passport: 'Passeport',
  },
  finding: {
    'carried-by': 'porté par', 'moves-at-plus': 'bouge vers + à', 'moves-at-minus': 'bouge vers − à', travel: 'course', mass: 'masse',
    damping: 'amortissement', 'dry-friction': 'frottement sec', delay: 'retard', 'known-force': 'force connue', 'carried-with': 'porté avec', 'let-go-after': 'lâche après',
    'responds-up-to': 'répond comme mesuré jusqu’à', 'drive-lag': 'retard de l’entraînement',
  },
  away: { x: 'en l’éloignant de vous', y: 'vers votre gauche', z: 'vers le haut' },
  axis: 'l’axe {name}',
  plus: 'dans son sens + (un doigt: fermer)',
  ask: {
    device: 'Est-ce l’appareil au numéro de série {serial}?', deviceMore: 'Pilote {driver}, micrologiciel {firmware}. Comparez avec l’étiquette de l’appareil.',
    nobody: 'Personne n’est attaché à l’appareil?', nobodyYes: 'Personne n’est attaché', nobodyNo: 'Si, quelqu’un', nobodyMore: 'Posez l’appareil sur son repère, là où vous le poserez chaque jour. Détachez tout le monde. Il peut bouger dès maintenant.',
    push: 'Poussez {axis} {way}', pushMore: 'D’environ un dixième de sa course. Laissez-le là.',
    travel: 'Bougez {axis} d’une butée à l’autre', travelMore: 'Lentement, à la main, jusqu’à une butée, puis jusqu’à l’autre. Mesurez la distance.', travelField: 'Distance',
    force: 'Tirez {axis} avec une force connue', forceMore: 'Contre son sens +, avec un poids sur une poulie ou un peson: {lower} à {upper} {unit}.', forceField: 'Force',
    estop: 'Relâchez l’arrêt d’urgence', estopMore: 'Il a coupé l’appareil. Relâchez-le, puis appuyez sur C’est fait.',
    next: 'Cette étape a échoué', nextMore: 'Corrigez, puis répétez l’étape.', repeat: 'Répéter: {step}', check: 'Contrôler à nouveau', earlier: 'Répéter une étape précédente', end: 'Terminer', noNumber: 'Un nombre supérieur à 0, sans unité.',
  },
  motion: [
    'L’appareil peut chercher son zéro lui-même. Seul son arrêt d’urgence y met fin.', '{axis} est poussé dans les deux sens.', 'L’effort qui porte {axis} est mesuré.',
    '{axis} est mené le long de sa course.', '{axis} est mesuré.', 'Le chien de garde est déclenché.', 'Appuyez sur l’arrêt d’urgence de l’appareil pendant que vous maintenez.',
  ],
  hold: 'Maintenir pour bouger', holdMore: 'Avec le pointeur ou la barre d’espace. L’appareil bouge tant que vous maintenez et s’arrête quand vous lâchez.', held: 'En mouvement: lâchez pour arrêter', ready: 'Rien ne bouge tant que vous ne maintenez pas.',
  lead: 'Diriger d’ici', leadHead: 'Personne ne dirige', leadMore: 'Une console dirige. Les autres regardent.', watchHead: 'Une autre console dirige', watchMore: 'Vous regardez. Vous pouvez arrêter l’appareil.', takeOver: 'Prendre la main',
  wait: 'Un instant', waitMore: 'Le programme travaille. Rien ne bouge.', connecting: 'Connexion en cours', lost: 'Connexion perdue', lostMore: 'Ce qui bougeait a été ramené au neutre. La page se reconnecte d’elle-même.',
  elsewhere: 'Aucun appareil n’est mis en service ici', elsewhereMore: 'Lancez: wholehand device commission --web',
  finished: 'Le passeport est écrit', finishedDaily: 'Contrôlé pour aujourd’hui', finishedMore: 'Enregistrement de tous les mouvements: {recording}', needsDaily: 'Il est valable 30 jours. Contrôlez l’appareil chaque jour avant son premier usage.',
  why: 'Constaté', remedy: 'À faire',
};
