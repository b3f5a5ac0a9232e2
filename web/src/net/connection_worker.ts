// Runs the connection to the program in a worker, and sends the heartbeat that shows that the page is alive (see worker_connection.ts).
// Browsers slow the timers of hidden pages down to 1 Hz and less, but not those of workers. Heartbeats also continue while the
// page draws for 300 ms; for a page that draws longer they say that it is busy (docs/adr/0017).
import type { Heartbeats } from './socket_connection';
import type { WorkerMessage, WorkerRequest } from './worker_connection';

const HEARTBEAT_MS = 50;
/** A page that has not answered for this long is busy [ms]. Building a picture takes less. */
const BUSY_MS = 3000;

let socket: WebSocket | undefined;
let heartbeats: Heartbeats | null = null;
let answered_ms = 0;

const post = (message: WorkerMessage, transfer: Transferable[] = []): void => { postMessage(message, { transfer }); };

function open(url: string): void {
  try {
    socket = new WebSocket(url);
  } catch {
    post({ is: 'closed', reason: '' });
    return;
  }
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => post({ is: 'open' });
  socket.onmessage = ({ data }: MessageEvent<unknown>) => post({ is: 'message', data }, data instanceof ArrayBuffer ? [data] : []);
  socket.onclose = ({ reason }) => post({ is: 'closed', reason });
}

function send(bytes: Uint8Array<ArrayBuffer>): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(bytes);
}

addEventListener('message', ({ data: order }: MessageEvent<WorkerRequest>) => {
  answered_ms = performance.now();
  switch (order.is) {
    case 'open': return open(order.url);
    case 'send': return send(order.bytes);
    case 'hold': heartbeats = order.heartbeats; return;
    case 'answer': return;
    case 'close':
      socket?.close();
      close();
  }
});

setInterval(() => {
  if (!heartbeats) return;
  post({ is: 'ask' });
  send(performance.now() - answered_ms < BUSY_MS ? heartbeats.alive : heartbeats.busy);
}, HEARTBEAT_MS);
