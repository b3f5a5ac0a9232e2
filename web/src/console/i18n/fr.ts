import type { ConsoleTexts } from './en';

export const fr: ConsoleTexts = {
  title: 'Wholehand : console',
  hand: { right: 'droite', left: 'gauche' },
  session: 'Séance {n}',
  level: 'Niveau {n}',
  levelOf: 'Niveau {n} sur {m}',
  drinkOf: 'boisson {n} sur {m}',
  exercises: { 'cocktail-bar': 'Bar à cocktails', 'free-grasping': 'Saisie libre' },
  hands: {
    'adult-median-right': 'Médiane, droite', 'adult-median-left': 'Médiane, gauche',
    'woman-p05-right': 'Femme P5, droite', 'woman-p50-right': 'Femme P50, droite', 'woman-p95-right': 'Femme P95, droite',
    'man-p05-right': 'Homme P5, droite', 'man-p50-right': 'Homme P50, droite', 'man-p95-right': 'Homme P95, droite',
  },
  patients: {
    'relaxed-adult': 'Adulte détendu', 'stiff-adult': 'Adulte raide', 'no-arm': 'Sans bras', tremor: 'Tremblement', spastic: 'Spasticité',
    releases: 'Lâche', slams: 'Frappe', fights: 'Résiste', 'enslaved-fingers': 'Doigts liés', 'spastic-fist': 'Poing spastique',
    'pill-rolling': 'Tremblement d’émiettement', 'holds-a-ball': 'Tient une balle',
  },
  noExercise: 'Aucun exercice',

  states: {
    connecting: 'Connexion', lost: 'Connexion perdue', disarmed: 'Désarmé', rendering: 'En marche',
    paused: 'Pause', stopping: 'S’arrête', stopped: 'Arrêté', faulted: 'Défaut',
    armed: 'Armé',
  },
  pill: {
    connecting: 'Attend le programme', lost: 'Rien ici n’est actuel', disarmed: 'Rien ne pousse',
    rendering: 'Limites tenues', limited: 'Force à sa limite', paused: 'L’exercice attend',
    stopping: 'Retour au neutre', stopped: 'Au neutre', faulted: 'Au neutre',
  },

  theme: 'Sombre ou clair',
  language: 'Langue',
  tables: 'Tableaux au lieu des courbes',
  pause: 'Pause', resume: 'Reprendre', arm: 'Démarrer', armAgain: 'Réarmer', stop: 'Arrêt doux',
  emergency: 'Arrêt d’urgence',
  space: 'Espace', esc: 'Échap',

  plots: {
    hand: 'Force, main', arm: 'Force, bras', axis: 'Coordonnée', ratios: 'φ et α',
    device: 'appareil', avatar: 'avatar', limit: 'limite', now: 'ici', axisChoice: 'Axe',
    image: '{name} : les 10 dernières secondes. Les nombres avec « Tableaux ».',
    series: 'Courbe', latest: 'Maintenant', least: 'Minimum', most: 'Maximum',
    tableCaption: '{name}, 10 dernières secondes', fault: 'défaut', stop: 'arrêt',
  },
  axes: {
    x: 'x', y: 'y', z: 'z', roll: 'roulis', pitch: 'tangage', yaw: 'lacet',
    finger_flexion: 'doigts', thumb_circumduction: 'rotation', thumb_flexion: 'pouce',
  },
  axesLong: {
    x: 'x, loin', y: 'y, gauche', z: 'z, haut', roll: 'Roulis', pitch: 'Tangage', yaw: 'Lacet',
    finger_flexion: 'Doigts', thumb_circumduction: 'Pouce, rotation', thumb_flexion: 'Pouce, flexion',
  },
  axesKey: {
    x: 'x', y: 'y', z: 'z', roll: 'ro', pitch: 'ta', yaw: 'la',
    finger_flexion: 'd', thumb_circumduction: 'r', thumb_flexion: 'p',
  },
  phases: { bump: 'touche', engaged: 'prise, le mur apparaît', pour: 'verse', release: 'lâche' },

  view: {
    title: 'Vue 3D', skin: 'Peau', colliders: 'Collisions', choice: 'Main dessinée en',
    none: 'Pas de vue 3D : ce navigateur n’a pas WebGL. Tout le reste fonctionne.',
    loading: 'La vue 3D se prépare …',
  },
  pouring: '{liquid}, {a} / {b} ml',

  safety: {
    title: 'Sécurité', peaks: 'pics des 10 dernières s', state: 'État',
    noFault: 'Aucun défaut', cause: 'Cause : {what}',
    nothingYet: 'Rien ne s’est passé depuis le départ.',
    lastNotice: '{time} : {what}',
    disarmed: 'Pas démarré', disarmedWhat: 'L’appareil ne pousse pas. Démarrez quand la personne est prête.',
    stopping: 'La force revient au neutre', stoppingWhat: 'Cela dure un dixième de seconde au plus. Le bras est porté.',
    stopped: 'Arrêté sur demande', stoppedWhat: 'La force est au neutre, le bras est porté. Réarmez quand tout est prêt.',
    faultedWhat: 'La force est revenue au neutre en 0,1 s. Le bras est porté.',
    armed: 'Armé', armedWhat: 'La force s’installe progressivement.', emergency: 'Arrêt d’urgence demandé', beyond: '{value}, limite {limit}',
    lost: 'Pas de connexion au programme',
    lostWhat: 'Si le programme tourne, la force de l’exercice s’éteint d’elle-même. Les chiffres ici datent d’avant.',
    fingers: 'Doigts', thumb: 'Pouce', arm: 'Bras x y z', speed: 'Vitesse bras', of: '{a} sur {b}',
  },
  advice: {
    'device read failed': 'Vérifiez le câble et le courant de l’appareil, puis réarmez.',
    'device write failed': 'Vérifiez le câble et le courant de l’appareil, puis réarmez.',
    'non-finite device position': 'Vérifiez le câble et le courant de l’appareil, puis réarmez.',
    'non-finite effort': 'Rechargez l’exercice, puis démarrez. Si cela revient, prévenez la personne qui s’occupe du programme.',
    'non-finite state': 'Rechargez l’exercice, puis démarrez. Si cela revient, prévenez la personne qui s’occupe du programme.',
    'physics step failed': 'Rechargez l’exercice, puis démarrez. Si cela revient, prévenez la personne qui s’occupe du programme.',
    'singular reduced inertia': 'Rechargez l’exercice, puis démarrez. Si cela revient, prévenez la personne qui s’occupe du programme.',
    'bodies exploded': 'Rechargez l’exercice, puis démarrez. Si cela revient, prévenez la personne qui s’occupe du programme.',
    'speed limit exceeded': 'Voyez que la personne est calme et le bras libre, puis réarmez.',
    'workspace left': 'Ramenez la main au milieu, puis réarmez.',
    'encoder jumped': 'Ne continuez pas avec cet appareil avant qu’il soit vérifié.',
    'encoder stuck': 'Ne continuez pas avec cet appareil avant qu’il soit vérifié.',
    'drive fault': 'Cherchez le code du moteur dans le manuel du fabricant, acquittez-le, puis réarmez.',
    'enable lost': 'Relâchez l’arrêt d’urgence de l’appareil ou appuyez sur son bouton de validation, puis réarmez.',
    'stale sample': 'Vérifiez le câble et le courant de l’appareil, puis réarmez.',
    'late ticks in a row': 'L’ordinateur était trop lent : fermez d’autres programmes, puis réarmez.',
    'gap too long': 'L’ordinateur était trop lent : fermez d’autres programmes, puis réarmez.',
    other: 'Réarmez quand la cause a disparu.',
  },

  timing: {
    title: 'Temps par pas', missed: '{n} manqués sur {m}', deadline: 'délai {t}', slower: 'pas plus longs',
    image: 'Combien de pas ont duré plus longtemps qu’un temps, en microsecondes : la moitié {p50}, un sur cent {p99}, un sur mille {p999}, le plus lent {max}.',
    max: 'max, µs', dropped: '{n} données perdues',
  },

  setup: {
    title: 'Séance', exercise: 'Exercice', level: 'Niveau', hand: 'Main', load: 'Charger', steering: 'Qui joue',
    virtual: 'Patient virtuel', person: 'Personne', next: 'Suite', restart: 'Recommencer',
    yours: 'Commandes : ici', free: 'Commandes : libres', others: 'Commandes : prises',
    take: 'Prendre les commandes', takeShort: 'Prendre', giveBack: 'Rendre',
  },

  parameters: {
    title: 'Paramètres', groups: { 0: 'Patient', 1: 'Main', 2: 'Exercice' },
    ramp: 'rampe → {v}', range: '{name}, de {lo} à {hi} {unit}', none: 'Rien à régler ici.',
    notANumber: 'Entrez un nombre de {lo} à {hi}.', refused: 'Inchangé : {reason}',
    names: {
      effort_limit_hand_tip_n: 'Limite de force, main',
      effort_limit_arm_n: 'Limite de force, bras',
      damping_full_n: 'Amortissement, plein à',
      damping_decay_s: 'Amortissement s’éteint en',
      wall_stiffness_ratio: 'Raideur du mur',
      wall_damping_ratio: 'Amortissement du mur',
      lead_in_m: 'Mur avant le contact',
      squeeze_threshold_ratio: 'Pression requise',
    },
  },

  recordings: {
    title: 'Enregistrements', none: 'Pas encore d’enregistrement.', failed: 'La liste n’a pas pu être lue. Nouvel essai en cours.',
    report: 'Rapport', download: 'Télécharger', reportOf: 'Rapport de {name}', downloadOf: 'Télécharger {name}', now: 'En cours',
  },

  notices: {
    lost: 'Connexion perdue. Les chiffres datent d’avant.', lostMore: 'Si le programme tourne, la force de l’exercice s’éteint d’elle-même.',
    unconfirmed: 'Arrêt non confirmé : bouton rouge.', unconfirmedMore: 'Cette page continue d’envoyer l’arrêt.',
    left: 'Vous avez quitté cette page : les commandes ont été rendues, et la force de l’exercice reste éteinte jusqu’à ce que quelqu’un les prenne.',
    unheard: 'Le programme n’a pas entendu cette page : les commandes ont été rendues, et la force de l’exercice reste éteinte jusqu’à ce que quelqu’un les prenne.',
    hardware: 'Le bouton rouge du robot agit toujours.', retry: 'Réessayer', attempts: 'Essai {n} …',
    held: 'Un autre client a les commandes : vous regardez. L’arrêt d’urgence agit toujours.',
    version: 'Le programme parle la version {theirs} des messages, cette page la version {ours}. Rechargez la page.',
    refused: '{what} a été refusé : {reason}', close: 'Fermer',
  },
};
