// Runs the line to the program in a worker, and sends the beat that shows that the page lives (see worker_line.ts).
// Browsers slow the timers of hidden pages down to 1 Hz and less, but not those of workers. A page that draws for 300 ms
// does not fall silent either.
import type { FromLine, ToLine } from './worker_line';

const BEAT_MS = 50;
/** A page that has not answered for this long hangs, and its beat ends [ms]. Building a picture takes less. */
const HANGS_MS = 3000;

let socket: WebSocket | undefined;
let beat: Uint8Array<ArrayBuffer> | null = null;
let answered_ms = 0;

const tell = (message: FromLine, transfer: Transferable[] = []): void => { postMessage(message, { transfer }); };

function open(url: string): void {
  try {
    socket = new WebSocket(url);
  } catch {
    tell({ is: 'closed', reason: '' });
    return;
  }
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => tell({ is: 'open' });
  socket.onmessage = ({ data }: MessageEvent<unknown>) => tell({ is: 'message', data }, data instanceof ArrayBuffer ? [data] : []);
  socket.onclose = ({ reason }) => tell({ is: 'closed', reason });
}

function send(bytes: Uint8Array<ArrayBuffer>): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(bytes);
}

addEventListener('message', ({ data: order }: MessageEvent<ToLine>) => {
  answered_ms = performance.now();
  switch (order.is) {
    case 'open': return open(order.url);
    case 'send': return send(order.bytes);
    case 'hold': beat = order.beat; return;
    case 'answer': return;
    case 'close':
      socket?.close();
      close();
  }
});

setInterval(() => {
  if (!beat) return;
  tell({ is: 'ask' });
  if (performance.now() - answered_ms < HANGS_MS) send(beat);
}, BEAT_MS);
