// Spoken instructions by the browser's voices. Only local voices are used, so that nothing is sent to a server.
import { language, store, stored, type Language } from '../shared/i18n';

const STORED = 'wholehand.speech';
/** Text is spoken after it was shown for this long [ms]; shorter texts would be outdated before they are heard. */
const STEADY_MS = 500;
/** Rate of the voice; 1 is the browser's default. */
const RATE = 0.9;

/** A local voice of the language, preferably of the person's country. */
export function voiceOf(voices: readonly SpeechSynthesisVoice[], wanted: Language, wishes: readonly string[]): SpeechSynthesisVoice | null {
  const ours = voices.filter(({ lang, localService }) => localService && lang.slice(0, 2).toLowerCase() === wanted);
  const wish = wishes.find((one) => one.slice(0, 2).toLowerCase() === wanted)?.toLowerCase();
  const same = ours.find(({ lang }) => lang.replace('_', '-').toLowerCase() === wish);
  return same ?? ours.find((voice) => voice.default) ?? ours[0] ?? null;
}

/** Decides which text is spoken: text that is new and was shown for STEADY_MS. */
export class Announcer {
  private title = '';
  private more = '';
  private saidTitle = '';
  private saidMore = '';
  private since_ms = 0;

  /** @return the text to speak now; '' none */
  look(title: string, more: string, now_ms: number): string {
    if (title !== this.title || more !== this.more) {
      [this.title, this.more, this.since_ms] = [title, more, now_ms];
    }
    if (now_ms - this.since_ms < STEADY_MS || (title === this.saidTitle && more === this.saidMore)) return '';
    const words = title === this.saidTitle ? more : [title, more].filter(Boolean).join('. ');
    [this.saidTitle, this.saidMore] = [title, more];
    return words;
  }

  /** Forgets the spoken text, so that the text on the screen is spoken again. */
  forget(): void { this.saidTitle = this.saidMore = ''; }
}

export class Speech {
  on = stored(STORED) === 'on';
  private readonly announcer = new Announcer();
  private readonly synthesis: SpeechSynthesis | undefined = typeof speechSynthesis === 'undefined' ? undefined : speechSynthesis;

  /** @param onVoices called when the browser has found its voices, which may be late */
  constructor(onVoices: () => void) { this.synthesis?.addEventListener?.('voiceschanged', onVoices); }

  get hasVoice(): boolean { return this.voice() !== null; }

  toggle(): void {
    this.on = !this.on;
    store(STORED, this.on ? 'on' : 'off');
    this.announcer.forget();
    if (!this.on) this.synthesis?.cancel();
  }

  /** Updates the text on the screen, and speaks what is new in it. */
  onInstruction(title: string, more: string, now_ms: number): void {
    if (!this.on) return;
    const words = this.announcer.look(title, more, now_ms);
    if (words) this.speak(words);
  }

  private voice(): SpeechSynthesisVoice | null {
    return voiceOf(this.synthesis?.getVoices() ?? [], language(), navigator.languages);
  }

  /** Speaks at once and cancels earlier speech. */
  private speak(words: string): void {
    const voice = this.voice();
    if (!voice || !this.synthesis) return;
    const utterance = new SpeechSynthesisUtterance(words);
    utterance.voice = voice;
    utterance.lang = voice.lang;
    utterance.rate = RATE;
    this.synthesis.cancel();
    this.synthesis.speak(utterance);
  }
}
