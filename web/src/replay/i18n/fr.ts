import type { ReplayTexts } from './en';

export const fr: ReplayTexts = {
  title: '{name} : relecture', brand: 'Relecture',
  report: 'Rapport', reportOf: 'Rapport de {name}',
  making: 'Le rapport se prépare … {s} s', makingLine: 'En cours', opening: 'L’enregistrement s’ouvre …', loading: '{percent} % lus',
  sides: { a: 'A', b: 'B' },

  transport: {
    title: 'Lecture', play: 'Lire', pause: 'Pause', space: 'Espace', back: 'Un pas en arrière', forward: 'Un pas en avant', home: 'Au début', end: 'À la fin',
    earlier: 'Au repère précédent', later: 'Au repère suivant', speed: 'Vitesse', zoomIn: 'Fenêtre plus courte', zoomOut: 'Fenêtre plus longue', whole: 'Tout',
    tick: 'pas {n} sur {m}', near: 'lecture en cours …', window: 'Fenêtre de {a} à {b}',
  },
  timeLine: {
    title: 'Ligne du temps', position: '{time}, {tick}', begin: 'Début de la fenêtre', end: 'Fin de la fenêtre',
    help: 'Flèches : un pas. Avec Maj : un dixième de seconde. Pages : repères. Plus et moins : la fenêtre.',
  },
  plots: {
    image: '{name}, de {a} à {b}. Les nombres : « Tableaux ».', tableCaption: '{name}, dans la fenêtre', latest: 'À la tête de lecture',
    intention: 'voulu', parts: 'Force, {axis}', sent: 'envoyé', exercise: 'exercice', damping: 'amortissement',
    contact: 'Contact', force: 'force', count: 'contacts', palm: 'Paume à l’objet', distance: 'distance', duration: 'Temps par pas', took: 'durée',
    value: 'Exercice', valueOthers: 'Mesures, pour la technique', valueChoice: 'Valeur de l’exercice', hint: 'Clic : y aller. Tirer : agrandir. Ctrl et molette : plus long ou plus court.',
    title: 'Courbes',
  },
  facts: {
    title: 'Enregistrement', when: 'Quand', exercise: 'Exercice', hand: 'Main', patient: 'Patient', device: 'Appareil', simulated: 'simulé', length: 'Durée',
    ticks: '{n} pas', missing: 'Manquent', end: 'Fin', ends: { stop: 'par quelqu’un', fault: 'par un défaut', broken_off: 'interrompue : l’enregistrement n’a pas de fin' } as Record<string, string>, program: 'Programme', result: 'Résultat', noExercise: 'Aucun',
  },
  moments: {
    title: 'Repères', none: 'Rien ne s’est passé dans cette fenêtre.', more: '{n} sur {m}, autour de la tête de lecture. Une fenêtre plus courte en montre moins.', gap: '{n} pas manquent',
    kinds: {
      stop: 'Arrêt', emergency_stop: 'Arrêt d’urgence', fault: 'Défaut', controls_lost: 'Commandes perdues', armed: 'Armé', neutral: 'Au neutre',
    },
    short: { stop: 'arrêt', emergency_stop: 'arrêt d’urgence', fault: 'défaut', controls_lost: 'commandes perdues', armed: 'armé', neutral: 'neutre', gap: 'trou' },
    events: {
      approached: 'Près d’un objet', touched: 'Touché', engaged: 'Saisi', disengaged: 'Lâché',
      level_done: 'Niveau fini', paused: 'Pause', resumed: 'Reprise', restarted: 'Recommencé',
    },
  },
  notices: {
    differs: 'Ce qui diffère de A : {what}.', axesOfOne: 'Axes d’un seul enregistrement : {axes}.',
    failed: '{name} n’est pas affiché. {why}',
    written: 'Cet enregistrement est encore en cours d’écriture.', readOn: 'Lire la suite',
    damaged: 'À partir de {time}, le fichier est illisible.', damagedEnd: 'La fin du fichier est illisible.', holes: '{n} pas manquent : marqués sur la ligne du temps.',
    noPicture: 'Pas d’image : {why}', noPictureAtAll: 'Pas d’image : la scène ne peut pas être construite à partir de ce fichier.', noExercise: 'Enregistré sans exercice.',
    gone: 'Le programme ne répond pas. Ce qui est lu reste ; le reste viendra à son retour.', retry: 'Essayer maintenant',
    piece: 'Une partie de l’enregistrement est illisible : {why}', empty: 'L’enregistrement n’a aucun pas.',
  },
  problems: {
    unknown: 'Il n’y a pas d’enregistrement de ce nom.', denied: 'Le programme demande un jeton. Ouvrez la relecture depuis la console.',
    unreadable: 'Cet enregistrement ne peut pas être ouvert.', gone: 'Le programme ne répond pas.', nonsense: 'Le programme répond quelque chose que cette page ne comprend pas. Rechargez la page ; sinon, mettez le programme à jour.',
    none: 'L’adresse ne nomme aucun enregistrement : /replay?recording=NOM. La console les énumère.', says: 'Le programme dit :', again: 'Réessayer', console: 'À la console',
  },
};
