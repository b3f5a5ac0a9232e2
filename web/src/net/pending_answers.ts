/** `reason` is for the person, in the page's language; empty when accepted. `unheard`: refused, since the page drew and was not heard in time. */
export interface Answer { readonly accepted: boolean; readonly reason: string; readonly unheard?: boolean }

interface PendingAnswer { readonly settle: (answer: Answer) => void; readonly timer: ReturnType<typeof setTimeout> }

/** Orders without an answer of the program yet, by their numbers. */
export class PendingAnswers {
  private readonly waiting = new Map<number, PendingAnswer>();

  /** @param otherwise the answer after `within_ms` without one */
  wait(id: number, within_ms: number, otherwise: Answer): Promise<Answer> {
    this.settle(id, otherwise);  // an order that is sent again replaces the earlier one
    return new Promise((settle) => {
      const timer = setTimeout(() => this.settle(id, otherwise), within_ms);
      this.waiting.set(id, { settle, timer });
    });
  }

  settle(id: number, answer: Answer): void {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    clearTimeout(waiting.timer);
    this.waiting.delete(id);
    waiting.settle(answer);
  }

  settleAll(answer: Answer): void {
    for (const id of [...this.waiting.keys()]) this.settle(id, answer);
  }
}
