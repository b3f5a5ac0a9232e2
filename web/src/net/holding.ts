// Tracks whether this page holds the controls, whether it must send heartbeats, and why it lost the controls.
import { Role } from '../protocol';

/** Why this page lost the controls without giving them back: the person left the page, the program did not hear it, or a therapist took them. */
export type Loss = '' | 'left' | 'unheard' | 'taken';

/** The holder of the controls, and the role of this page. */
export interface Hands {
  readonly heldByYou: boolean;
  readonly held: boolean;
  /** The role that the program granted; Unspecified from a program without roles. */
  readonly role: Role;
  readonly holder: Role;
  /** A therapist's page is open. */
  readonly led: boolean;
}

const NOBODY: Hands = { heldByYou: false, held: false, role: Role.Unspecified, holder: Role.Unspecified, led: false };

export class ControlHolding {
  hands: Hands = NOBODY;
  /** Why the controls were lost, until they are taken again. */
  loss: Loss = '';
  /** The person has left the page. */
  away = false;
  private taking = 0;        // orders without an answer yet
  private starting = 0;      // orders that start the device, without an answer yet
  private giving = false;    // the controls are being given back at the person's wish
  private wanted = false;    // the last order requested the controls instead of giving them back
  private heartbeatOn = false;   // as last set on the connection
  private told: Hands = NOBODY;  // the program's last report, also while the person is away

  /** @param keep begins or ends the heartbeats that show that the page is alive */
  constructor(private readonly keep: (needsHeartbeat: boolean) => void) {}

  get needsHeartbeat(): boolean { return !this.away && (this.hands.heldByYou || this.taking > 0 || this.starting > 0); }

  /** The page gives an order that starts the device. Heartbeats show that its person is there until it is answered: else nothing starts. */
  onStartAsked(): void {
    this.starting += 1;
    this.updateHeartbeat();
  }

  onStartAnswered(): void {
    this.starting -= 1;
    this.updateHeartbeat();
  }

  /** The page requests the controls. Heartbeats begin before the answer can be read: a busy page would lose the controls at once. */
  requestControls(): void {
    this.taking += 1;
    this.wanted = true;
    this.updateHeartbeat();
  }

  onAnswer(accepted: boolean): void {
    this.taking -= 1;
    if (accepted) {
      this.loss = '';
      if (this.wanted) {
        this.giving = false;
        this.told = { ...this.told, heldByYou: true, held: true };
        this.set({ ...this.hands, heldByYou: true, held: true });
      }
    }
    this.updateHeartbeat();
  }

  giveBack(): void {
    this.giving = true;
    this.wanted = false;
  }

  leave(rendering: boolean): void {
    this.away = true;
    this.update({ ...this.hands, heldByYou: false }, rendering);
  }

  /** The person is back. What the program has not taken meanwhile goes on without a press. */
  comeBack(): void {
    if (!this.away) return;
    this.away = false;
    if (this.told.heldByYou && !this.giving) {
      this.loss = '';
      this.set(this.told);
    }
    this.updateHeartbeat();
  }

  /** Applies the program's report of who holds the controls. */
  onReport(hands: Hands, rendering: boolean): void {
    this.told = hands;
    this.update(hands, rendering);
  }

  private update(hands: Hands, rendering: boolean): void {
    const lost = this.hands.heldByYou && !hands.heldByYou && !this.giving;
    // A stop takes the controls from a player; that is not reported as a loss.
    if (lost && this.away) this.loss = 'left';
    else if (lost && hands.held) this.loss = 'taken';
    else if (lost && (rendering || hands.role !== Role.Player)) this.loss = 'unheard';
    this.set(hands);
    this.giving &&= hands.heldByYou;
    this.updateHeartbeat();
  }

  /** Records that rendering has ended: the apparent silence was the stop that took the controls from a player. */
  onStop(): void {
    if (this.loss === 'unheard' && this.hands.role === Role.Player) this.loss = '';
  }

  /** Forgets the controls after the connection was lost. */
  onConnectionLost(): void {
    this.hands = this.told = NOBODY;
    this.giving = this.heartbeatOn = false;
  }

  private set(hands: Hands): void { this.hands = this.away ? { ...hands, heldByYou: false } : hands; }

  private updateHeartbeat(): void {
    if (this.needsHeartbeat === this.heartbeatOn) return;
    this.heartbeatOn = this.needsHeartbeat;
    this.keep(this.heartbeatOn);
  }
}
