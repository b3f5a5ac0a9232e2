import type { ConsoleModel } from '../console/model';
import type { Connection } from '../net/connection';
import type { PacedView } from '../scene/paced_view';
import type { Clinic } from './clinic';
import type { Route } from './routes';

/** The part of the page that its screens use. */
export interface ClinicContext {
  readonly clinic: Clinic;
  readonly model: ConsoleModel;
  readonly connection: Connection;
  go(route: Route): void;
  /** Shows a message below the header until it is closed. */
  showMessage(words: string, bad?: boolean): void;
  /** Loads the 3D view of the hand, once. */
  picture(): Promise<PacedView | undefined>;
  /** Builds the visible screen again. */
  build(): void;
}
