// The screen is written in the address after "#". It contains numbers only, because addresses are seen, stored and sent.

export type Route =
  | { readonly at: 'patients' | 'new' | 'settings' | 'alone' }
  | { readonly at: 'patient' | 'edit' | 'limits' | 'progress'; readonly patient: number }
  | { readonly at: 'summary'; readonly patient: number; readonly visit: number }
  | { readonly at: 'visit' | 'end'; readonly visit: number };

export function routeOf(hash: string): Route {
  const parts = hash.replace(/^#\/?/, '').split('/');
  const [place, first, more, second] = parts;
  const number = (text: string | undefined): number => (/^\d{1,16}$/.test(text ?? '') ? Number(text) : 0);
  const id = number(first);
  if (place === 'new' || place === 'settings' || place === 'alone') return { at: place };
  if (place === 'visit' && id > 0) return { at: more === 'end' ? 'end' : 'visit', visit: id };
  if (place === 'patient' && id > 0) {
    if (more === 'edit' || more === 'limits' || more === 'progress') return { at: more, patient: id };
    if (more === 'visit' && number(second) > 0) return { at: 'summary', patient: id, visit: number(second) };
    return { at: 'patient', patient: id };
  }
  return { at: 'patients' };
}

export function hashOf(route: Route): string {
  switch (route.at) {
    case 'patients': case 'new': case 'settings': case 'alone': return `#/${route.at}`;
    case 'patient': return `#/patient/${route.patient}`;
    case 'edit': return `#/patient/${route.patient}/edit`;
    case 'limits': return `#/patient/${route.patient}/limits`;
    case 'progress': return `#/patient/${route.patient}/progress`;
    case 'summary': return `#/patient/${route.patient}/visit/${route.visit}`;
    case 'visit': return `#/visit/${route.visit}`;
    case 'end': return `#/visit/${route.visit}/end`;
  }
}
