// The stars that a person has won: of a visit, or of a patient's profile. Without either they are those of the present play.
import { store, stored } from '../shared/i18n';

const STORED = 'wholehand.stars';

export class Stars {
  private owner = '';
  private unowned = 0;

  /** @param visit 0: none @param profile '': none */
  belongTo(visit: bigint | number, profile: string): void {
    this.owner = Number(visit) > 0 ? `visit-${visit}` : profile;
  }

  /** Another person may be here now. */
  begin(): void { this.unowned = 0; }

  /** A stored value that is not a count is read as 0. */
  get count(): number {
    if (this.owner === '') return this.unowned;
    const count = Number(stored(`${STORED}.${this.owner}`) ?? 0);
    return Number.isInteger(count) && count > 0 ? count : 0;
  }

  add(won: number): number {
    const count = this.count + Math.max(0, Math.round(won));
    if (this.owner === '') this.unowned = count;
    else store(`${STORED}.${this.owner}`, String(count));
    return count;
  }
}
