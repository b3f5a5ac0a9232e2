import type { ReportTexts } from './en';

export const fr: ReportTexts = {
  title: 'Rapport : {name}', report: 'Rapport', replay: 'Revoir la séance', print: 'Imprimer', therapy: 'Thérapie', engineering: 'Technique',
  pageOf: 'Page {n} sur {m}', program: 'Programme {version}', notDiagnosis: 'Pas un diagnostic. Chaque nombre vient de l’enregistrement.',
  reading: 'Lecture du rapport …', none: 'aucun', time: 'Temps', seconds: 's',
  facts: { patient: 'Patient', hand: 'Main', device: 'Appareil', exercise: 'Exercice', date: 'Date', length: 'Durée', file: 'Fichier', simulated: 'simulé', noExercise: 'Sans exercice', unknown: 'non précisé' },
  tiles: {
    levels: 'niveaux terminés', of: 'sur {n}', reach: 'pour saisir, en moyenne', grip: 'force de prise, en moyenne', steadiness: 'variation de la prise',
    touched: 'objets touchés', held: 'tenu en tout', force: 'plus grande force de contact', effort: 'plus grand effort, {axis}',
  },
  whose: {
    who: ['personne', 'le patient', 'le patient virtuel', 'un mouvement rejoué'], moved: '{who} : la main {n} % du temps ({time})',
    active: 'Actif : {time}', activeHelped: 'dont {time} avec un peu d’aide', led: 'guidé : {time}',
    helps: ['', 'avec toute l’aide', 'avec un peu d’aide', 'sans aide'], helped: 'Du patient : {helps}.',
    person: 'du patient', shared: 'partagé, {n} % du patient', shown: ['personne ne bougeait', 'du patient', 'montré par le patient virtuel', 'montré par un mouvement rejoué'],
    unknown: 'Cet enregistrement ne dit pas qui bougeait la main : il est plus ancien, et sa main était simulée.',
    things: { band_held: 'zones', level_done: 'niveaux', reach: 'approches', grip: 'prises' } as Record<string, string>,
    apart: '{what} : {n}', sharedCount: '{n} en partage', othersCount: '{n} pas du patient', touches: 'contacts : {n}', notCounted: 'Non comptés : {what}.',
    rule: 'Une partie de l’exercice, un niveau, une approche, une prise ou un contact compte si le patient a bougé la main à chaque pas, du premier au dernier ; ce qu’un autre a bougé en partie est partagé et n’entre dans aucune somme.',
  },
  before: { was: 'avant : {x}', better: 'mieux', compared: 'Avant : {name}, {date}.', other: 'Ce qui diffère : {what}.', not: 'Non comparés : {what}.', nothing: 'Aucun chiffre n’est comparable.' },
  steadinessNote: 'Prise : au moins 1 N pendant au moins 1 s. Sa variation est son écart type rapporté à sa moyenne ; les premières et dernières 0,25 s de chaque prise ne comptent pas.',
  happened: {
    title: 'Arrêts et défauts', emergency_stop: 'Arrêt d’urgence', stop: 'Arrêt', fault: 'Défaut', controls_lost: 'Commandes perdues', missing: 'Cycles manquants', missed: 'Périodes sautées', limited: 'Effort à sa limite',
    at: 'à {times}', more: '{times} et {n} autres', ticks: '{n} cycles', lost: '{n} cycles, {s} s', unreadable: 'À partir de {time}, le fichier est illisible.', unreadableEnd: 'La fin du fichier est illisible.',
    written: 'L’enregistrement était encore en cours.', brokenOff: 'La séance a été interrompue : l’enregistrement n’a pas de fin, car le programme ou la machine est tombé en panne, ou le disque était plein.', truncated: 'Il s’est passé plus que cette page ne contient.',
  },
  picture: { caption: 'Contact le plus fort : {n} N à {time}', last: 'À la fin, {time}', none: 'Pas d’image : ce navigateur n’a pas WebGL. Tout le reste fonctionne.', noScene: 'Pas d’image : {why}', drawing: 'L’image se dessine …' },
  bodies: { title: 'Ce qui a été tenu', body: 'Objet', first: 'D’abord à', touches: 'Contacts', longest: 'Contact le plus long, s', held: 'Tenu, s', force: 'Force, N', way: 'Déplacé, cm', nothing: 'Aucun chiffre n’est comparable.', noBodies: 'Il n’y avait rien à toucher.', more: 'et {n} autres', note: 'Tenu : doigts d’un côté, pouce ou paume de l’autre, ou une prise que l’exercice compte.' },
  charts: {
    grip: 'Force de prise', goal: 'demandé', contact: 'Force de contact', limits: 'Limites d’effort en vigueur', effortHand: 'Effort, main', effortArm: 'Effort, bras', phi: 'Amortissement adaptatif φ', alpha: 'Paroi de l’exercice α',
    handPosition: 'Position, main', armPosition: 'Position, bras', palm: 'Paume à l’objet le plus proche', count: 'Points de contact', times: 'Temps par cycle', timesCpu: 'Temps de calcul par cycle', ticks: 'cycles', click: 'Cliquer un graphique : revoir cet instant.', missing: 'Rouge pâle : manque.', touchesLeftOut: 'Non grisés : {n} autres contacts ; les chiffres les comptent.', limitsThinned: 'Les changements d’une limite en moins de {s} s sont tracés comme un seul.', touches: 'Ombré : la main touche quelque chose.',
  },
  compared: {
    title: 'Différences senties', threshold: 'Trois différences de {n} % sur quatre sont senties ({interval}).', between: '95 % : {a} à {b} %', below: '95 % : moins de {n} %', above: '95 % : plus de {n} %', atLimit: 'C’est la limite de l’appareil.',
    notEnough: 'Pas assez pour un seuil : {why}.', answers: 'Réponses : {n}{by}.', other: 'Qui ne compare que la profondeur de la pression a raison dans {n} %.', notPersons: 'Pas celles d’une personne : quelqu’un d’autre bougeait la main.',
    why: { answers: 'il manque {n} réponses', guesses: 'les réponses ne suivent pas les différences', one_answer: 'presque toutes les réponses sont les mêmes', compares_other: 'la profondeur de la pression explique mieux les réponses', misses_catches: 'de grandes différences ont échappé', beyond_range: 'ces différences ne montrent que des seuils jusqu’à {most} %' } as Record<string, string>,
    by: { squeeze: '{n} en pressant', player: '{n} par touche', therapist: '{n} dites par le thérapeute', earlier: '{n} avant un repos' } as Record<string, string>,
    chart: '« La deuxième était plus », selon la différence', fitted: 'ajustée', points: 'réponses',
  },
  stages: {
    title: 'Temps de calcul d’un cycle, µs', stage: 'Étape', max: 'max.', whole: 'cycle entier',
    names: { device_read: 'lecture', observe: 'observation', dynamics: 'dynamique', control: 'commande', exercise: 'exercice', safety: 'sécurité', device_write: 'écriture', physics_step: 'pas physique', contacts: 'contacts' },
  },
  faults: { title: 'Défauts par cycles', fault: 'Défaut', ticks: 'Cycles', axis: 'Surtout sur' },
  settings: {
    title: 'Réglages', scene: 'Scène', rendering: 'Rendu', engine: 'Moteur physique', rate: 'Cadence', simulatedClock: 'horloge simulée', realTime: 'temps réel', gains: 'Gains', accepted: 'acceptés', uncertified: 'NON certifiés', paper: 'loi de l’article',
    passport: 'Passeport', seed: 'Graine', deadlines: 'Échéances manquées', damped: 'Amortissement φ au-dessus de 0,5', share: '{n} % du temps', coupling: 'Plus grande erreur de couplage', work: 'Travail de l’appareil', limits: 'Limites de l’appareil',
  },
  problems: {
    template: 'Cette page ne contient pas d’enregistrement. Un rapport se fait avec : wholehand replay --report rapport.html ENREGISTREMENT.h5', old: 'Ce navigateur est trop ancien pour cette page. L’ouvrir avec un navigateur de 2023 ou plus récent.',
    broken: 'Les données de cette page sont illisibles. Refaire le rapport.', says: 'Raison :',
  },
};
