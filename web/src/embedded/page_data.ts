// The data that the program wrote into a page of one file (src/page): JSON, with bytes packed into texts.

export type Json = Readonly<Record<string, unknown>>;

/** What the page carries; null in a template that no program has written to. */
export function pageData(page: Document): Json | null {
  try {
    const data: unknown = JSON.parse(page.querySelector('#page-data')?.textContent ?? 'null');
    return typeof data === 'object' && data !== null && !Array.isArray(data) ? (data as Json) : null;
  } catch {
    return null;
  }
}

/** Bytes of packBytes(): base 64 of a zlib stream. Fails where the text is none. */
export async function unpackBytes(text: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}
