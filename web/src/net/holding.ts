// Keeps whether this page has the controls, when it must beat, and why it lost the controls.
import { Role } from '../protocol';

/** Why this page lost the controls, which it did not give back: the person left it, the program did not hear it, or a therapist took them. */
export type Loss = '' | 'left' | 'unheard' | 'taken';

/** Who has the controls, and the role of this page. */
export interface Hands {
  readonly heldByYou: boolean;
  readonly held: boolean;
  /** The role that the program granted; Unsaid from one that knows no roles. */
  readonly role: Role;
  readonly holder: Role;
  /** A therapist's page is open. */
  readonly led: boolean;
}

const NOBODY: Hands = { heldByYou: false, held: false, role: Role.Unsaid, holder: Role.Unsaid, led: false };

export class Holding {
  hands: Hands = NOBODY;
  /** Why the controls were lost, until they are taken anew. */
  loss: Loss = '';
  /** The person has left the page. */
  away = false;
  private taking = 0;        // orders without an answer yet
  private giving = false;    // the controls are being given back, at the person's wish
  private wanted = false;    // the last order asked for the controls, and did not give them back
  private beating = false;   // as last set on the line

  /** @param keep begins the beats that say that the page is there, or ends them */
  constructor(private readonly keep: (beats: boolean) => void) {}

  get beats(): boolean { return !this.away && (this.hands.heldByYou || this.taking > 0); }

  /** The page asks for the controls. Beats begin before the answer can be read: a busy page would lose them at once. */
  asks(): void {
    this.taking += 1;
    this.wanted = true;
    this.tellLine();
  }

  answered(accepted: boolean): void {
    this.taking -= 1;
    if (accepted) {
      this.loss = '';
      if (this.wanted) {
        this.giving = false;
        this.set({ ...this.hands, heldByYou: true, held: true });
      }
    }
    this.tellLine();
  }

  gives(): void {
    this.giving = true;
    this.wanted = false;
  }

  leave(rendering: boolean): void {
    this.away = true;
    this.update({ ...this.hands, heldByYou: false }, rendering);
  }

  /** The program says who has the controls. */
  update(hands: Hands, rendering: boolean): void {
    const lost = this.hands.heldByYou && !hands.heldByYou && !this.giving;
    // A stop takes the controls from a player; that is not reported as a loss.
    if (lost && this.away) this.loss = 'left';
    else if (lost && hands.held) this.loss = 'taken';
    else if (lost && (rendering || hands.role !== Role.Player)) this.loss = 'unheard';
    this.set(hands);
    this.giving &&= hands.heldByYou;
    this.tellLine();
  }

  /** Takes note that rendering has ended: what looked like silence was the stop that took the controls from a player. */
  ended(): void {
    if (this.loss === 'unheard' && this.hands.role === Role.Player) this.loss = '';
  }

  /** Forgets the controls: there is no connection any more. */
  lineGone(): void {
    this.hands = NOBODY;
    this.giving = this.beating = false;
  }

  private set(hands: Hands): void { this.hands = this.away ? { ...hands, heldByYou: false } : hands; }

  private tellLine(): void {
    if (this.beats === this.beating) return;
    this.beating = this.beats;
    this.keep(this.beating);
  }
}
