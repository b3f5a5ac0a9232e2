// The data that the program wrote into a page of one file (src/files/page): JSON, with bytes packed into texts.

export type Json = Readonly<Record<string, unknown>>;

/** What the page carries; null in a template that no program has written to. A SyntaxError where it is damaged. */
export function pageData(page: Document): Json | null {
  // It stands last: where a file is cut, the page still runs, and says so.
  const data: unknown = JSON.parse(page.querySelector('#page-data')?.textContent ?? '');
  return typeof data === 'object' && data !== null && !Array.isArray(data) ? (data as Json) : null;
}

/** Bytes of packBytes(): base 64 of a zlib stream. Fails where the text is none. */
export async function unpackBytes(text: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}
