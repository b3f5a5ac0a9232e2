// Spoken instructions, by the browser's own voices: only those of this machine, as nothing is asked of any other server.
import { language, store, stored, type Language } from '../shared/i18n';

const STORED = 'wholehand.speech';
/** Words are spoken after they have stood for this long [ms]; shorter ones would be over before they are heard. */
const STEADY_MS = 500;
/** Rate of the voice; 1 is the browser's usual one. */
const RATE = 0.9;

/** A voice of the language on this machine: the one of the person's country first. */
export function voiceOf(voices: readonly SpeechSynthesisVoice[], wanted: Language, wishes: readonly string[]): SpeechSynthesisVoice | null {
  const ours = voices.filter(({ lang, localService }) => localService && lang.slice(0, 2).toLowerCase() === wanted);
  const wish = wishes.find((one) => one.slice(0, 2).toLowerCase() === wanted)?.toLowerCase();
  const same = ours.find(({ lang }) => lang.replace('_', '-').toLowerCase() === wish);
  return same ?? ours.find((voice) => voice.default) ?? ours[0] ?? null;
}

/** Decides which words are spoken: those that are new and have stood for long enough. */
export class Announcer {
  private title = '';
  private more = '';
  private saidTitle = '';
  private saidMore = '';
  private since_ms = 0;

  /** @return what to say now; '' nothing */
  look(title: string, more: string, now_ms: number): string {
    if (title !== this.title || more !== this.more) {
      [this.title, this.more, this.since_ms] = [title, more, now_ms];
    }
    if (now_ms - this.since_ms < STEADY_MS || (title === this.saidTitle && more === this.saidMore)) return '';
    const words = title === this.saidTitle ? more : [title, more].filter(Boolean).join('. ');
    [this.saidTitle, this.saidMore] = [title, more];
    return words;
  }

  /** Forgets what was spoken, so that the words on the screen are spoken again. */
  forget(): void { this.saidTitle = this.saidMore = ''; }
}

export class Speech {
  on = stored(STORED) === 'on';
  private readonly announcer = new Announcer();
  private readonly synthesis: SpeechSynthesis | undefined = typeof speechSynthesis === 'undefined' ? undefined : speechSynthesis;

  /** @param onVoices called when the browser has found its voices: some do so late */
  constructor(onVoices: () => void) { this.synthesis?.addEventListener?.('voiceschanged', onVoices); }

  get hasVoice(): boolean { return this.voice() !== null; }

  toggle(): void {
    this.on = !this.on;
    store(STORED, this.on ? 'on' : 'off');
    this.announcer.forget();
    if (!this.on) this.synthesis?.cancel();
  }

  /** Takes the words on the screen, and speaks what is new of them once they have stood. */
  tell(title: string, more: string, now_ms: number): void {
    if (!this.on) return;
    const words = this.announcer.look(title, more, now_ms);
    if (words) this.say(words);
  }

  private voice(): SpeechSynthesisVoice | null {
    return voiceOf(this.synthesis?.getVoices() ?? [], language(), navigator.languages);
  }

  /** Speaks at once: words that are still being spoken are out of date. */
  private say(words: string): void {
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
