// Whose a part of an exercise is: only what the person moved from its begin to its end is credited.
import type { Play } from '../exercises/exercise';
import { RunState, Steering, type WorldStateT } from '../protocol';
import { hasHardware } from '../shared/hardware';

export class Credit {
  /** Everything of the present part was moved by the person, as far as this page has seen; a page that came later has not. */
  own = false;

  follow(state: WorldStateT, play: Play): void {
    if (play.atStart(state)) this.own = true;
    else if (state.runState === RunState.Rendering && !play.isPaused(state) && play.phase(state) !== 'success' && !hasHardware(state) && state.steering !== Steering.Person) this.own = false;
  }
}
