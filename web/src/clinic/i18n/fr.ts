import type { ClinicTexts } from './en';

// Français : vouvoiement, phrases courtes.
export const fr: ClinicTexts = {
  title: 'Wholehand : cabinet', clinic: 'Cabinet', places: 'Écrans', close: 'Fermer', again: 'Réessayer', console: 'Ouvrir la console', todayWord: 'aujourd’hui',
  visitOpen: 'Séance en cours', backToVisit: 'Retour à la séance',
  names: { hide: 'Masquer les noms', show: 'Montrer les noms' },
  silentSince: 'Les dossiers ne répondent plus depuis {at}. La séance, l’arrêt et la pause continuent.', waiting: 'En attente sur cette machine : {n}.',
  silentNow: 'Les dossiers ne répondent pas.',
  answerAgain: 'Les dossiers répondent de nouveau.',
  stages: {
    looking: { title: 'Recherche des dossiers', words: 'Un instant …' },
    without: { title: 'Pas de dossiers sur ce poste', words: 'Lancez le programme avec un répertoire : wholehand run --clinic RÉPERTOIRE, ou ./start --clinic RÉPERTOIRE.' },
  },
  alone: {
    begin: 'Séance sans dossiers', title: 'Séance sans dossiers', words: 'Avec le réglage doux. Elle est enregistrée. Quand les dossiers répondent de nouveau, vous la donnez à un patient, ou vous l’effacez.',
    visitGoesOn: 'La séance en cours continue', visitWords: 'Avec ses limites. Son programme et son nom reviennent avec les dossiers.', wrongSide: 'Le poste est réglé pour : {side}. Changez l’appareil, ou choisissez l’autre main dans la console.', leave: 'Aux patients, tels qu’ils ont été lus',
  },
  refusals: {
    locked: 'Les dossiers sont verrouillés. Entrez la phrase secrète.', not_signed_in: 'Identifiez-vous de nouveau.', hidden: 'Les noms sont masqués. Entrez votre code PIN.',
    wrong_pin: 'Mauvais code PIN. Essais restants : {tries_left}.', too_many_tries: 'Trop d’essais. Attendez {wait_s} s.', wrong_phrase: 'Ce n’est ni la phrase secrète ni le code de secours.',
    not_found: 'Ce n’est plus dans les dossiers.', code_exists: 'Un autre patient a ce code.', changed: 'Quelqu’un d’autre l’a modifié entre-temps.', visit_open: 'Une autre séance est en cours. Terminez-la d’abord.',
    station: 'Le poste a refusé : {why}', station_silent: 'Le poste n’a pas répondu en 5 s. Réessayez.', no_recording: 'Il n’y en a pas d’enregistrement.',
    database: 'Les dossiers ne peuvent pas être enregistrés : {why}', busy: 'Les dossiers sont occupés. Réessayez.',
  },
  sides: { right: 'main droite', left: 'main gauche', both: 'deux mains' },
  helps: { full: 'Beaucoup', some: 'Un peu', none: 'Aucune' }, helpOf: 'Aide : {help}', min: '{n} min',
  presets: { usual: 'Habituel', gentle: 'Doux', strong: 'Fort', first: 'Première séance', short: 'Court', long: 'Long' },
  results: {
    poured_total_l: 'Versé', spilt_l: 'Renversé', bands_done: 'Niveaux faits', time_s: 'Temps',
    active_min: 'Minutes actives', score: 'Points', reach_s: 'Temps pour atteindre', peak_speed_m_s: 'Vitesse maximale', path_ratio: 'Trajet sur ligne droite', helped_share: 'Aidé',
  },
  curves: { one: 'Une seule séance jusqu’ici. Les courbes viennent après deux.', short: 'moins d’une minute', none: 'Rien n’est encore mesuré.', image: '{name} sur {n} séances, de {first} à {last}.' },
  first: {
    title: 'Premier démarrage', words: 'La phrase secrète ouvre les dossiers une fois par jour. Sans elle et sans le code de secours, personne ne pourra plus les lire.',
    folder: 'Les dossiers sont créés dans {path}.', folderEmpty: 'Le répertoire est vide.', folderAsk: 'S’il y avait déjà des dossiers : son disque est-il monté ?',
    phrase: 'Phrase secrète', phraseHint: '8 caractères ou plus', again: 'Phrase secrète, encore', tile: 'Qui travaille ici', name: 'Nom', pin: 'Code PIN', pinHint: '4 à 8 chiffres', make: 'Créer les dossiers',
    short: 'Prenez 8 caractères ou plus.', differs: 'Les deux ne sont pas pareilles.', noName: 'Entrez un nom.', badPin: 'Entrez 4 à 8 chiffres.',
    code: { title: 'Code de secours', words: 'Il ouvre les dossiers si la phrase secrète est oubliée. Il n’est montré que cette fois.', paper: 'Imprimez-le et gardez-le sous clé, pas près de cet ordinateur.', print: 'Imprimer', kept: 'Je l’ai sur papier', on: 'Continuer' },
  },
  tile: { colour: 'Couleur', colours: ['Vert', 'Bleu', 'Pourpre', 'Brun', 'Violet', 'Rouge'] },
  unlock: { mistyped: 'Le code est mal tapé. Comparez-le avec celui qui est imprimé, groupe par groupe.', title: 'Ouvrir les dossiers', words: 'Une fois par jour, et après un redémarrage.', phrase: 'Phrase secrète', code: 'Code de secours', open: 'Ouvrir', byCode: 'Prendre le code de secours', byPhrase: 'Prendre la phrase secrète' },
  who: { title: 'Qui travaille ?', again: 'Les noms sont masqués', kept: 'Ce que vous avez écrit est gardé.', pin: 'Code PIN', ok: 'OK', back: 'Effacer le dernier chiffre', other: 'Quelqu’un d’autre' },
  picker: { find: 'Nom ou code', cancel: 'Annuler', nobody: 'Personne n’a ce nom ni ce code.' },
  patients: {
    title: 'Patients', find: 'Nom ou code', fresh: 'Nouveau patient', count: '{n} patients', countOne: '1 patient', name: 'Nom', code: 'Code', hand: 'Main', last: 'Dernière séance', visits: 'Séances', never: 'aucune',
    empty: 'Pas encore de patients.', nobody: 'Personne ne s’appelle « {find} ».', failed: 'Pas lu depuis {at}. Nouvel essai automatique ; si cela dure, relancez le programme.', asOf: 'La liste date de {at}.',
    open: 'en cours', unfinished: 'inachevée', goOn: 'Continuer', endIt: 'Terminer', without: 'Séance sans patient', withoutMore: 'Avec le réglage doux. Vous la donnez plus tard à un patient, ou vous l’effacez.', beginWith: 'Commencer, {side}',
    sessions: { title: 'Séances sans patient', words: 'Enregistrées pendant que les dossiers ne répondaient pas, ou hors d’une séance.', choose: 'Choisir la séance du {day}, {at}', give: 'Donner à un patient', whose: 'À qui était cette séance ?', more: 'Et {n} autres.' },
    noPatient: 'sans patient', give: 'Donner à un patient', giveTo: 'À qui était cette séance ?', giveYes: 'La donner à {name}, {code}', remove: 'Effacer', removeYes: 'Effacer pour toujours',
  },
  plan: {
    add: 'Ajouter un exercice', exercise: 'Exercice {n}', level: 'Niveau de l’exercice {n}', levelShort: 'Niveau', help: 'Aide dans l’exercice {n}', less: 'Moins de temps pour l’exercice {n}', more: 'Plus de temps pour l’exercice {n}', up: 'Exercice {n} plus tôt', remove: 'Enlever l’exercice {n}',
  },
  form: {
    title: 'Nouveau patient', edit: 'Modifier le patient', person: 'Personne', hands: 'Taille de la main', limits: 'Forces', plan: 'Programme', preset: 'Partir de', planPreset: 'Partir de', ownPlan: 'programme propre', save: 'Enregistrer', back: 'Abandonner',
    fields: { name: 'Nom', code: 'Code', born: 'Date de naissance', number: 'Numéro', side: 'Côté atteint', hands: 'Mains', preset: 'Forces', parameters: 'Portée et doigts', warnings: 'Avertissements', plan: 'Programme' },
    hints: { code: 'pas un nom', born: 'facultatif', number: 'facultatif', warnings: 'vus avant chaque séance' },
    length_m: 'Longueur', breadth_m: 'Largeur', measure: 'Longueur : du pli du poignet au bout du majeur. Largeur : sur les articulations, sans le pouce.', handImage: '{side}, longueur {length} mm, largeur {breadth} mm', sideFirst: 'Choisissez d’abord le côté atteint.',
    reach: 'Portée et doigts', kept: 'Ceci a été écrit avant et n’est pas encore enregistré.', stays: 'Ce que vous avez écrit reste ici.', noName: 'Entrez un nom.', bornLater: 'Ce jour n’est pas encore venu.', noSide: 'Choisissez un côté.',
    both: { title: 'Modifié par quelqu’un d’autre', words: 'Ce patient a été enregistré sur un autre écran pendant que vous écriviez.', yours: 'Le vôtre', now: 'Enregistré là', mine: 'Enregistrer le mien', theirs: 'Prendre l’autre' },
  },
  patient: {
    patient: 'Patient', reading: 'Lecture …', failed: 'Pas lu depuis {at}. Nouvel essai automatique.', asOf: 'État de {at}.', visitCount: '{n} séances', oneVisit: '1 séance', lastOn: 'dernière : {day}', noVisit: 'pas encore de séance',
    progress: 'Évolution', progressSince: 'Évolution depuis {day}', noProgress: 'Les courbes viennent après deux séances.', noClaim: 'Valeurs mesurées ; aucune n’est un jugement.', visits: 'Séances', noVisits: 'Pas encore de séances.', csv: 'Enregistrer en CSV', print: 'Imprimer l’évolution', all: 'Montrer les {n}', newest: 'Seulement les plus récentes',
    active: 'actives', painWords: 'douleur avant {before}, après {after}', nothingDone: 'Rien n’a été fait.', look: 'Regarder', move: 'Déplacer', open: 'en cours', unfinished: 'inachevée', noShow: 'pas venu', helped: 'aidé à {share} %', notByPerson: 'pas bougé par une personne', waiting: 'mesure en cours', failedTrial: 'pas mesuré : {why}', partly: 'd’une partie : l’enregistrement est incomplet', noRecording: 'pas d’enregistrement',
    replay: 'Rejouer', report: 'Rapport', compare: 'Comparer', notes: 'Notes', person: 'Personne', edit: 'Modifier', born: 'Naissance', number: 'Numéro', hand: 'Taille, {side}', preset: 'Forces',
    more: 'Erreurs et cas rares', noShowNote: 'Pas venu aujourd’hui', noShowYes: 'Le noter', moveTitle: 'À qui est la séance du {day}, {at} ?', moved: 'La séance est maintenant chez {name}, {code}.', moveYes: 'Déplacer vers {name}, {code}', remove: 'Effacer ce patient', removeYes: 'Effacer {name} pour toujours',
    merge: { title: 'Réunir avec un double', which: 'Qui est le double de {name}, {code} ?', yes: 'Réunir : {name}, {code} disparaît, les séances des deux sont ici', done: '{name}, {code} a été réuni avec cette personne.' },
    erase: { title: 'Tout effacer', words: 'Séances, notes et enregistrements sont effacés pour toujours, dans les copies en 30 jours.', code: 'Écrivez le code {code}', wrong: 'C’est un autre code.', press: 'Tout effacer', done: 'Effacé. La dernière copie qui connaît la personne disparaît dans 30 jours.' },
  },
  notes: {
    write: 'Écrivez une note. Elle est gardée à mesure.', done: 'Note finie', none: 'Pas encore de notes.', states: { empty: '', typing: 'gardée ici', saved: 'enregistrée', waits: 'gardée ici, enregistrée quand les dossiers répondent' },
    kinds: { tired: 'Fatigue', spasm: 'Spasme', cue: 'Indication', hands_on: 'Aide manuelle', next: 'La prochaine fois', reason: 'Pourquoi rien n’a été fait' },
  },
  pain: { unasked: 'pas demandée', before: 'Douleur avant', after: 'Douleur maintenant', notAsked: 'Pas demandé', of: 'Douleur {n} sur 10' },
  today: { title: 'Aujourd’hui', from: 'Comme le {day}', fromPlan: 'D’après le programme', begin: 'Commencer la séance {n}', goOn: 'Continuer la séance', preparing: 'La main est vérifiée et répétée, 20 s au plus.', openSince: 'En cours depuis {at}, commencée par {who}.', otherOpen: 'Aller à la séance en cours', side: 'Quelle main aujourd’hui ?', change: 'Changer le programme', ready: 'Le programme est prêt', noPlan: 'Le programme est vide. Ajoutez un exercice.', notNow: 'Une séance ne peut pas commencer ici tant que les dossiers ne répondent pas. Une séance sans dossiers le peut, avec le réglage doux.' },
  visit: {
    title: 'Séance', plan: 'Programme', noPatient: 'Sans patient', gentle: 'réglage doux', hiddenName: 'Nom masqué', recorded: '● Enregistrement', unrecorded: 'Pas enregistré', itemOf: '{n} sur {m}', active: 'actif : {item} sur {of} min, séance {all}', inProgress: 'en cours', done: 'fait', setUp: 'Préparer',
    next: 'Suite du programme', nextIs: 'Suite : {name}', end: 'Finir la séance', stop: 'Arrêter en douceur', marks: 'Noter d’une touche', noteTitle: 'Notes', pain: 'Douleur', another: 'Une autre séance est en cours.', over: 'Cette séance est finie.', endedElsewhere: 'Cette séance a été finie sur un autre écran, à {at}.',
    whichHand: 'Quelle main est dans l’appareil ?', whichHandMore: 'Regardez la personne, puis appuyez. Ensuite le départ est possible.', wrongSide: 'Cette séance est pour : {side}. Changez l’appareil, ou finissez cette séance et commencez-en une pour l’autre main.',
    notSetUp: 'Le poste n’a pas les réglages de cette séance. Appuyez sur « Préparer » à côté d’un exercice.', doesNotStop: 'Il ne s’est pas arrêté. Appuyez sur l’arrêt d’urgence.', staysAsItIs: 'L’exercice reste comme il est.',
  },
  end: {
    title: 'Fin de séance', doneTitle: 'Fait', nothing: 'Rien n’a été fait dans cette séance.', notDone: 'pas fait', of: '{done} sur {planned}', result: 'Résultat', now: 'Aujourd’hui', last: '{day}', lastNone: 'avant', noResults: 'Pas de résultats.',
    next: 'La suite', reason: 'Pourquoi rien n’a été fait', finish: 'Terminer la séance', unfinished: 'La laisser inachevée', back: 'Retour à l’exercice',
    card: { title: 'Votre entraînement aujourd’hui', trained: 'Vous vous êtes entraîné pendant {min}.', next: 'La prochaine fois :', nextPatient: 'Patient suivant', toPatient: 'Regarder la séance', print: 'Imprimer la carte' },
  },
  sheet: { back: 'Retour à {name}', print: 'Imprimer', nothing: 'Il n’y a encore rien à imprimer.', progress: 'Évolution', visit: 'Séance du', day: 'Jour', hand: 'Main', done: 'Fait', active: 'Actif', pain: 'Douleur avant → après' },
  settings: {
    title: 'Réglages', people: 'Qui travaille ici', newPerson: 'Une nouvelle personne', name: 'Nom', add: 'Ajouter', backupProblem: 'Échec : {why}', backup: 'Copie de sécurité', noFolder: 'Aucun répertoire pour les copies. Lancez le programme avec un.', noBackup: 'Pas encore de copie dans {folder}.', lastBackup: 'Dernière copie : {day}, {at}, dans {folder}.',
    export: 'Export', exportWords: 'Tous les patients par code, sans noms.', csvAll: 'Enregistrer en CSV', leaving: 'Fin de la journée', lockWords: 'Verrouillés, les dossiers redemandent la phrase secrète.', signOut: 'Quitter', lock: 'Verrouiller les dossiers',
  },
};
