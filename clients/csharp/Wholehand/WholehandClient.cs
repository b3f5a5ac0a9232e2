using System;
using System.Collections.Concurrent;
using System.Net;
using System.Net.Sockets;
using System.Text;
using System.Threading;
using FlatBuffers;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A game's connection to a running Wholehand over UDP: hand coordinates up to 1000 times a
    /// second, scenes, events and answers in order and complete, commands. It connects by itself, and
    /// again after the program was gone. Docs: docs/udp.md.</summary>
    public sealed partial class WholehandClient : IDisposable
    {
        private const long HelloPauseNs = 250000000;
        private const long GoneNs = 1000000000;
        private const long PollNs = 100000000;
        private const int PaceMs = 20;
        private const long HeartbeatPauseNs = 40000000;
        private const int LargestState = 64 * 1024;
        private static readonly byte[] Empty = new byte[0];

        private readonly ClientOptions options;
        private readonly Socket socket;
        private readonly Thread receiver, keeper;
        private readonly ManualResetEvent closing = new ManualResetEvent(false);
        private readonly ConcurrentQueue<System.Action> toRaise = new ConcurrentQueue<System.Action>();
        private volatile bool closed, holdsControls;

        // gate guards what both threads and the game's use.
        private readonly object gate = new object();
        private readonly byte[] outgoing = new byte[Datagram.LargestSize];
        private readonly FlatBufferBuilder builder = new FlatBufferBuilder(256);
        private readonly CommandQueue commands = new CommandQueue();
        private MessageAssembler newest = new MessageAssembler(LargestState);
        private MessageAssembler filling = new MessageAssembler(LargestState);
        private Scene? scene;
        private ReliableInbox inbox = new ReliableInbox();
        private uint session, sequence, command;
        private ulong nonce;
        private long heardNs, helloNs = long.MinValue / 2, heartbeatNs, polledNs;
        private bool haveState;
        private string refusal = "";

        /// <summary>Nothing is sent before Connect(). Throws ArgumentException for impossible
        /// options.</summary>
        public WholehandClient(ClientOptions options)
        {
            if (options.RateHz < 0 || options.RateHz > 1000)
            {
                throw new ArgumentException("the rate must be 0 to 1000 Hz", "options");
            }
            if (Encoding.UTF8.GetByteCount(options.Token ?? "") > 256)
            {
                throw new ArgumentException("the token is longer than 256 bytes", "options");
            }
            this.options = options;
            Statistics = new ClientStatistics();
            socket = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp);
            // Room for what comes while this process is held up, for a second or more.
            socket.ReceiveBufferSize = 4 * 1024 * 1024;
            socket.ReceiveTimeout = 200;
            receiver = new Thread(ReceiveLoop) { IsBackground = true, Name = "Wholehand receive" };
            keeper = new Thread(KeepLoop) { IsBackground = true, Name = "Wholehand heartbeat" };
        }

        /// <summary>Begins to connect; ConnectionChanged tells when it is done. Subscribe to events before;
        /// to be called once. Throws SocketException for an unknown host.</summary>
        public void Connect()
        {
            // Connected, the system drops what others send; and receiving allocates nothing.
            socket.Connect(options.Host, options.Port);
            polledNs = MonotonicClock.NowNs();
            receiver.Start();
            keeper.Start();
        }

        /// <summary>A state, newer than all before. Valid during the call only: TryGetState copies.
        /// Always raised on the client's own thread; not raised where options say Polled.</summary>
        public event Action<WorldState> StateReceived;

        /// <summary>The scene of the states from now on; its memory is the receiver's.</summary>
        public event Action<Scene> SceneReceived;

        public event Action<Events> EventsReceived;
        public event Action<Reply> ReplyReceived;
        public event Action<Controls> ControlsChanged;

        /// <summary>Connected or not, and in words why.</summary>
        public event Action<bool, string> ConnectionChanged;

        /// <summary>A handler of the game threw; without a handler for this it is written to the error
        /// stream. The client goes on.</summary>
        public event Action<Exception> HandlerThrew;

        public ClientStatistics Statistics { get; private set; }

        public bool Connected { get { lock (gate) return session != 0; } }

        /// <summary>Whether this client may command.</summary>
        public bool HoldsControls { get { return holdsControls; } }

        /// <summary>The newest scene; null before the first.</summary>
        public Scene? LatestScene { get { lock (gate) return scene; } }

        /// <summary>Why the program refuses to be connected to; empty: it does not.</summary>
        public string Refusal { get { lock (gate) return refusal; } }

        /// <summary>Copies the newest state; false where there is none, or none that is newer than
        /// <paramref name="into"/> already is. Any thread.</summary>
        public bool TryGetState(HandState into)
        {
            lock (gate)
            {
                if (!haveState) return false;
                try
                {
                    WorldState state = Words.StateOf(newest.Bytes);
                    if (state.Tick == into.Tick && state.Session == into.Session
                        && state.SentMonotonicNs == into.SentMonotonicNs)
                    {
                        return false;
                    }
                    into.CopyFrom(state);
                    return true;
                }
                catch (Exception e) when (IsOfRubbish(e))
                {
                    // Made by something else than Wholehand: its offsets lead nowhere.
                    haveState = false;
                    Statistics.CountIgnored();
                    return false;
                }
            }
        }

        /// <summary>Raises the events that wait, where options say Polled, and tells that the game is
        /// alive. To be called in every frame.</summary>
        public void Poll()
        {
            lock (gate) polledNs = MonotonicClock.NowNs();
            System.Action raise;
            while (toRaise.TryDequeue(out raise)) Guard(raise);
        }

        /// <summary>Says goodbye and ends both threads.</summary>
        public void Dispose()
        {
            lock (gate)
            {
                if (closed) return;
                closed = true;
                if (session != 0) SendEmpty(DatagramKind.Goodbye);
                session = 0;
                commands.Drop("the client was closed");
            }
            closing.Set();
            socket.Close();
            foreach (Thread thread in new[] { receiver, keeper })
            {
                if (thread.IsAlive && thread != Thread.CurrentThread) thread.Join();
            }
        }

        private void Raise(System.Action raise)
        {
            if (options.Polled) toRaise.Enqueue(raise);
            else Guard(raise);
        }

        private void Guard(System.Action raise)
        {
            try
            {
                raise();
            }
            catch (Exception e)
            {
                var threw = HandlerThrew;
                if (threw != null) threw(e);
                else Console.Error.WriteLine(e);
            }
        }

        // ---- sending; gate is held ----

        private void Send(DatagramKind kind, byte[] payload)
        {
            var header = new DatagramHeader { Kind = kind, Session = session, Sequence = ++sequence };
            int count = Math.Max(1, (payload.Length + Datagram.LargestPayload - 1) / Datagram.LargestPayload);
            header.FragmentCount = (ushort)count;
            for (int i = 0; i < count; ++i)
            {
                int from = i * Datagram.LargestPayload;
                header.FragmentIndex = (ushort)i;
                header.MonotonicNs = MonotonicClock.NowNs();
                int size = Datagram.Write(outgoing, header, payload, from,
                    Math.Min(Datagram.LargestPayload, payload.Length - from));
                SendBytes(size);
            }
        }

        private void SendEmpty(DatagramKind kind)
        {
            Send(kind, Empty);
        }

        private void SendBytes(int size)
        {
            try
            {
                socket.Send(outgoing, size, SocketFlags.None);
            }
            catch (SocketException)
            {
                // Nobody listens there at present, or the buffer is full: everything that matters is repeated.
            }
            catch (ObjectDisposedException)
            {
            }
        }

        private void SayHello(long nowNs)
        {
            if (nonce == 0) nonce = BitConverter.ToUInt64(Guid.NewGuid().ToByteArray(), 0) | 1;
            byte[] token = Encoding.UTF8.GetBytes(options.Token ?? "");
            var payload = new byte[12 + token.Length];
            LittleEndian.Put(payload, 0, (ushort)options.RateHz);
            LittleEndian.Put(payload, 2, Words.SchemaVersion);
            LittleEndian.Put(payload, 4, nonce);
            Buffer.BlockCopy(token, 0, payload, 12, token.Length);
            helloNs = nowNs;
            Send(DatagramKind.Hello, payload);
        }

        // ---- the thread that keeps the conversation alive ----

        private void KeepLoop()
        {
            while (!closing.WaitOne(PaceMs)) Keep(MonotonicClock.NowNs());
        }

        private void Keep(long nowNs)
        {
            bool lost = false;
            lock (gate)
            {
                if (closed) return;
                if (session != 0 && nowNs - heardNs > GoneNs)
                {
                    lost = true;
                    EndConversation("the program is not heard any more");
                }
                if (session == 0)
                {
                    if (nowNs - helloNs >= HelloPauseNs) SayHello(nowNs);
                }
                else
                {
                    SendWhatIsDue(nowNs);
                }
            }
            if (lost) RaiseConnection(false, "the program is not heard any more");
        }

        private void SendWhatIsDue(long nowNs)
        {
            bool alive = !options.Polled || nowNs - polledNs < PollNs;
            if (alive && nowNs - heartbeatNs >= HeartbeatPauseNs)
            {
                heartbeatNs = nowNs;
                SendEmpty(DatagramKind.Heartbeat);
            }
            byte[] due = commands.Due(nowNs);
            if (due != null) Send(DatagramKind.Message, due);
        }

        private void EndConversation(string why)
        {
            session = 0;
            nonce = 0;
            haveState = false;
            holdsControls = false;
            commands.Drop(why);
        }

        private void RaiseConnection(bool connected, string why)
        {
            Raise(() =>
            {
                var changed = ConnectionChanged;
                if (changed != null) changed(connected, why);
            });
        }
    }
}
