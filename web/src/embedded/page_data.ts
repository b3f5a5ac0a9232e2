// The data that the program wrote into a page of one file (src/files/page): JSON, with binary data encoded in strings.

export type Json = Readonly<Record<string, unknown>>;

/** The data of the page; null in a template without data. Throws a SyntaxError if it is damaged. */
export function pageData(page: Document): Json | null {
  // The data stands last, so that the page of a truncated file still runs and reports it.
  const data: unknown = JSON.parse(page.querySelector('#page-data')?.textContent ?? '');
  return typeof data === 'object' && data !== null && !Array.isArray(data) ? (data as Json) : null;
}

/** Decodes the output of packBytes(): base 64 of a zlib stream. Rejects if the text is invalid. */
export async function unpackBytes(text: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}
