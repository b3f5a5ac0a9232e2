using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.IO;
using System.Net;
using System.Net.Sockets;
using System.Net.WebSockets;
using System.Threading;
using System.Threading.Tasks;
using FlatBuffers;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A game's connection to a running Wholehand: scenes, events, commands and answers by
    /// WebSocket, in order and complete; hand coordinates up to 1000 times a second and aims by datagram,
    /// where only the newest counts. It connects by itself, and again after the program was absent. Docs:
    /// docs/udp.md.</summary>
    public sealed partial class WholehandClient : IDisposable
    {
        private const long GoneNs = 2000000000;
        private const long DatagramsGoneNs = 500000000;
        private const long PollNs = 100000000;
        private const int PaceMs = 10;
        private const long HeartbeatPauseNs = 40000000;
        private static readonly byte[] Empty = new byte[0];

        private readonly ClientOptions options;
        private readonly Thread listener, keeper;
        private readonly ManualResetEvent closing = new ManualResetEvent(false);
        private readonly ConcurrentQueue<System.Action> toRaise = new ConcurrentQueue<System.Action>();
        private volatile bool closed, connected, holdsControls;

        // gate guards data that the client's threads and the game's threads share.
        private readonly object gate = new object();
        private readonly byte[] outgoing = new byte[Datagram.LargestSize];
        private readonly FlatBufferBuilder builder = new FlatBufferBuilder(256);
        private readonly Dictionary<uint, TaskCompletionSource<CommandReply>> asked =
            new Dictionary<uint, TaskCompletionSource<CommandReply>>();
        private readonly Queue<byte[]> toSend = new Queue<byte[]>();
        private Task sending;
        private ClientWebSocket webSocket;
        // Ends the conversation: neither Abort() nor a token interrupts waiting for a WebSocket in mono.
        private TaskCompletionSource<bool> ended = new TaskCompletionSource<bool>();
        private Socket datagrams;   // null: the program has no datagrams
        private ulong key;
        private MessageBuffer newest = new MessageBuffer(), filling = new MessageBuffer();
        private MessageBuffer world = new MessageBuffer(); // the newest state by WebSocket, with bodies
        private Scene? scene;
        private uint sequence, command, stopId;
        private byte[] stopMessage; // an emergency stop that the program has not confirmed yet
        private long heardNs, heartbeatNs, polledNs, datagramNs, datagramSentNs;
        private bool haveState, haveWorld;
        private string refusal = "";

        /// <summary>Nothing is sent before Connect(). Throws ArgumentException for impossible
        /// options.</summary>
        public WholehandClient(ClientOptions options)
        {
            if (options.RateHz < 0 || options.RateHz > 1000)
            {
                throw new ArgumentException("the rate must be 0 to 1000 Hz", "options");
            }
            if ((options.Token ?? "").IndexOfAny(new[] { '\r', '\n', '\0' }) >= 0)
            {
                throw new ArgumentException("the token has a line break", "options");
            }
            this.options = options;
            Statistics = new ClientStatistics();
            listener = new Thread(Listen) { IsBackground = true, Name = "Wholehand messages" };
            keeper = new Thread(KeepLoop) { IsBackground = true, Name = "Wholehand heartbeat" };
        }

        /// <summary>Begins to connect; ConnectionChanged reports the result. Subscribe to events before;
        /// call it once.</summary>
        public void Connect()
        {
            polledNs = MonotonicClock.NowNs();
            listener.Start();
            keeper.Start();
        }

        /// <summary>A state that is newer than all before. Valid only during the call; TryGetState copies.
        /// Always raised on the client's own thread; not raised with the option Polled.</summary>
        public event Action<WorldState> StateReceived;

        /// <summary>The scene of later states. The receiver may keep it.</summary>
        public event Action<Scene> SceneReceived;

        public event Action<Events> EventsReceived;
        public event Action<Reply> ReplyReceived;
        public event Action<Controls> ControlsChanged;

        /// <summary>Whether it is connected, and a description of the reason.</summary>
        public event Action<bool, string> ConnectionChanged;

        /// <summary>A handler of the game threw; without a handler for this it is written to the error
        /// stream. The client continues.</summary>
        public event Action<Exception> HandlerThrew;

        public ClientStatistics Statistics { get; private set; }

        public bool Connected { get { return connected; } }

        /// <summary>Whether this client may command.</summary>
        public bool HoldsControls { get { return holdsControls; } }

        /// <summary>The newest scene; null before the first one.</summary>
        public Scene? LatestScene { get { lock (gate) return scene; } }

        /// <summary>Why the program refuses a connection; empty: it does not.</summary>
        public string Refusal { get { lock (gate) return refusal; } }

        /// <summary>Copies the newest state; false if there is none newer than
        /// <paramref name="into"/>. Any thread.</summary>
        public bool TryGetState(HandState into)
        {
            if (!TryCopy(ref newest, ref haveState, into)) return false;
            into.Basis = NewestBasis();
            return true;
        }

        // From the states by WebSocket, which follow the scene: a datagram may overtake it.
        private uint NewestBasis()
        {
            lock (gate)
            {
                try
                {
                    return haveWorld ? Words.StateOf(world.Bytes).Basis : 0;
                }
                catch (Exception e) when (IsOfRubbish(e))
                {
                    haveWorld = false;
                    return 0;
                }
            }
        }

        /// <summary>Copies bodies and contacts of the newest state by WebSocket, 60 per second; false if
        /// there is none newer than <paramref name="into"/>. Any thread.</summary>
        public bool TryGetWorld(WorldSnapshot into)
        {
            return TryCopy(ref world, ref haveWorld, into);
        }

        // Passed by reference: another thread exchanges the buffers while gate is free.
        private bool TryCopy(ref MessageBuffer from, ref bool have, Snapshot into)
        {
            lock (gate)
            {
                if (!have) return false;
                try
                {
                    WorldState state = Words.StateOf(from.Bytes);
                    if (into.IsOf(state)) return false;
                    into.CopyFrom(state);
                    into.ReceivedNs = from.ReceivedNs;
                    return true;
                }
                catch (Exception e) when (IsOfRubbish(e))
                {
                    // The message was not made by Wholehand: its offsets are invalid.
                    have = false;
                    Statistics.CountIgnored();
                    return false;
                }
            }
        }

        /// <summary>Raises the waiting events with the option Polled, and reports that the game is
        /// alive. Call it in every frame.</summary>
        public void Poll()
        {
            lock (gate) polledNs = MonotonicClock.NowNs();
            System.Action raise;
            while (toRaise.TryDequeue(out raise)) Guard(raise);
        }

        /// <summary>Ends the connection and the threads.</summary>
        public void Dispose()
        {
            lock (gate)
            {
                if (closed) return;
                closed = true;
                EndConversation("the client was closed");
            }
            closing.Set();
            foreach (Thread thread in new[] { listener, keeper })
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

        private void SendMessage(byte[] message)
        {
            toSend.Enqueue(message);
            SendNext();
        }

        // A WebSocket sends one message at a time.
        private void SendNext()
        {
            if (webSocket == null || toSend.Count == 0 || (sending != null && !sending.IsCompleted)) return;
            try
            {
                sending = webSocket.SendAsync(new ArraySegment<byte>(toSend.Dequeue()),
                    WebSocketMessageType.Binary, true, CancellationToken.None);
                sending.ContinueWith(sent =>
                {
                    // The listening thread detects a failure, too.
                    if (sent.Exception == null) lock (gate) SendNext();
                });
            }
            catch (Exception e) when (IsOfTheLine(e))
            {
            }
        }

        private void SendDatagram(DatagramKind kind, byte[] payload)
        {
            if (datagrams == null) return;
            long nowNs = MonotonicClock.NowNs();
            var header = new DatagramHeader
            {
                Kind = kind, Key = key, Sequence = ++sequence, RateOrStop = (uint)options.RateHz, SentNs = nowNs,
                EchoNs = datagramSentNs, EchoAgeUs = (uint)Math.Min(uint.MaxValue, (nowNs - datagramNs) / 1000)
            };
            int size = Datagram.Write(outgoing, header, payload, 0, payload.Length);
            try
            {
                datagrams.Send(outgoing, size, SocketFlags.None);
            }
            catch (Exception e) when (IsOfTheLine(e))
            {
                // Nobody listens there at present, or the buffer is full: the next aim corrects it.
            }
        }

        // ---- the thread that keeps the conversation alive ----

        private void KeepLoop()
        {
            while (!closing.WaitOne(PaceMs))
            {
                lock (gate) Keep(MonotonicClock.NowNs());
            }
        }

        private void Keep(long nowNs)
        {
            if (webSocket == null) return;
            if (nowNs - heardNs > GoneNs)
            {
                ended.TrySetResult(true); // the listening thread continues there
                return;
            }
            if (!connected) return;
            if (stopMessage != null) SendDatagram(DatagramKind.Command, stopMessage);
            bool alive = !options.Polled || nowNs - polledNs < PollNs;
            if (!alive || nowNs - heartbeatNs < HeartbeatPauseNs) return;
            heartbeatNs = nowNs;
            SendDatagram(DatagramKind.Alive, Empty);
            if (toSend.Count == 0) SendMessage(Words.Heartbeat(builder));
        }

        private void EndConversation(string why)
        {
            connected = haveState = haveWorld = holdsControls = false;
            DropBodies();
            toSend.Clear();
            DropCommands(why);
            if (datagrams != null) datagrams.Close();
            ended.TrySetResult(true);
            datagrams = null;
            webSocket = null;
            sending = null;
        }

        private void RaiseConnection(bool isConnected, string why)
        {
            Raise(() =>
            {
                var changed = ConnectionChanged;
                if (changed != null) changed(isConnected, why);
            });
        }

        // Receives the program's messages on the WebSocket, on a thread of its own.

        private const int RetryPauseMs = 250;
        private const int ConnectPatienceMs = 2000;
        private const int LargestMessage = 4 * 1024 * 1024;

        private void Listen()
        {
            do
            {
                string why = Converse();
                bool was;
                lock (gate)
                {
                    was = connected;
                    EndConversation(why);
                    if (closed) return;
                    if (!was && refusal == why) continue;
                    refusal = was ? "" : why;
                }
                RaiseConnection(false, why);
            }
            while (!closing.WaitOne(RetryPauseMs));
        }

        // Runs one conversation from connecting to its end; returns a description of why it ended.
        private string Converse()
        {
            using (var socket = new ClientWebSocket())
            {
                var end = new TaskCompletionSource<bool>();
                lock (gate)
                {
                    if (closed) return "the client was closed";
                    ended = end;
                }
                try
                {
                    if (!string.IsNullOrEmpty(options.Token))
                    {
                        socket.Options.SetRequestHeader("Authorization", "Bearer " + options.Token);
                    }
                    var address = new UriBuilder("ws", options.Host, options.Port, "ws").Uri;
                    Task connecting = socket.ConnectAsync(address, CancellationToken.None);
                    int first = Task.WaitAny(new[] { connecting, end.Task }, ConnectPatienceMs);
                    if (first != 0) throw new IOException("no answer");
                    connecting.GetAwaiter().GetResult();
                    lock (gate)
                    {
                        if (closed) return "the client was closed";
                        heardNs = MonotonicClock.NowNs();
                        webSocket = socket;
                    }
                    while (true) ReceiveMessage(socket, end.Task);
                }
                catch (Exception e) when (IsOfTheLine(e))
                {
                    if (closed) return "the client was closed";
                    return connected ? "the connection is lost: " + e.Message : InWords(e);
                }
            }
        }

        private static bool IsOfTheLine(Exception e)
        {
            return e is WebSocketException || e is SocketException || e is IOException
                || e is ObjectDisposedException || e is OperationCanceledException || e is InvalidOperationException;
        }

        // A WebSocket does not report why it was refused; a plain HTTP request does.
        private string InWords(Exception e)
        {
            try
            {
                var asking = (HttpWebRequest)WebRequest.Create(new UriBuilder("http", options.Host, options.Port, "ws").Uri);
                asking.Timeout = ConnectPatienceMs;
                asking.Headers["Authorization"] = "Bearer " + options.Token;
                asking.GetResponse().Close();
            }
            catch (WebException refused)
            {
                var answer = refused.Response as HttpWebResponse;
                if (answer != null && answer.StatusCode == HttpStatusCode.Unauthorized)
                {
                    return "the program asks for another token";
                }
            }
            return "no connection to " + options.Host + ":" + options.Port + ": " + e.Message;
        }

        private byte[] incoming = new byte[64 * 1024];

        private void ReceiveMessage(ClientWebSocket socket, Task end)
        {
            int length = 0;
            while (true)
            {
                if (length == incoming.Length) Array.Resize(ref incoming, 2 * length);
                if (length > LargestMessage) throw new IOException("a message that is too large");
                var room = new ArraySegment<byte>(incoming, length, incoming.Length - length);
                Task<WebSocketReceiveResult> receiving = socket.ReceiveAsync(room, CancellationToken.None);
                Task.WaitAny(receiving, end);
                if (end.IsCompleted) throw new IOException("the program is not heard any more");
                WebSocketReceiveResult part = receiving.GetAwaiter().GetResult();
                if (part.MessageType == WebSocketMessageType.Close) throw new IOException("the program has ended");
                length += part.Count;
                if (part.EndOfMessage) break;
            }
            long nowNs = MonotonicClock.NowNs();
            lock (gate) heardNs = nowNs;
            try
            {
                Hear(incoming, length, nowNs);
            }
            catch (Exception e) when (IsOfRubbish(e))
            {
                // FlatBuffers read outside of the message: another program made it.
                Statistics.CountIgnored();
            }
        }

        private static bool IsOfRubbish(Exception e)
        {
            return e is ArgumentException || e is IndexOutOfRangeException || e is InvalidOperationException
                || e is OverflowException;
        }

        private ByteBuffer inPlace = new ByteBuffer(new byte[8]);
        private byte[] inPlaceBytes; // bytes of inPlace

        // Processes any bytes of the WebSocket. Tests call it, too.
        internal void Hear(byte[] bytes, int length, long nowNs)
        {
            if (bytes != inPlaceBytes)
            {
                inPlace = new ByteBuffer(bytes);
                inPlaceBytes = bytes;
            }
            if (!Words.IsMessage(inPlace, length))
            {
                Statistics.CountIgnored();
                return;
            }
            if (Message.GetRootAsMessage(inPlace).PayloadType == Payload.WorldState)
            {
                lock (gate)
                {
                    world.CopyFrom(bytes, 0, length, nowNs);
                    haveWorld = true;
                }
                // At 0 Hz no states come by datagram.
                if (options.RateHz == 0 || !DatagramsCome(nowNs)) Show(bytes, 0, length, nowNs);
                return;
            }
            // Handlers may keep their arguments.
            var own = new byte[length];
            Buffer.BlockCopy(bytes, 0, own, 0, length);
            Deliver(Message.GetRootAsMessage(new ByteBuffer(own)));
        }

        private void Deliver(Message message)
        {
            switch (message.PayloadType)
            {
                case Payload.Welcome:
                    Begin(message.PayloadAsWelcome());
                    break;
                case Payload.Scene:
                    Scene newScene = message.PayloadAsScene();
                    TakeBodyEventsOf(newScene);
                    lock (gate) scene = newScene;
                    Raise(SceneReceived, newScene);
                    break;
                case Payload.Events:
                    Raise(EventsReceived, message.PayloadAsEvents());
                    RaiseBodyEvents(message.PayloadAsEvents());
                    break;
                case Payload.GameBodies:
                    GameBodies bodies = message.PayloadAsGameBodies();
                    Take(bodies);
                    Raise(BodiesChanged, bodies);
                    break;
                case Payload.Controls:
                    Controls controls = message.PayloadAsControls();
                    holdsControls = controls.HeldByYou;
                    Raise(ControlsChanged, controls);
                    break;
                case Payload.Reply:
                    Reply reply = message.PayloadAsReply();
                    var answer = new CommandReply(reply.Accepted, reply.Reason, reply.Refusal, ItemsOf(reply));
                    lock (gate) Answer(reply.Command, answer);
                    Raise(ReplyReceived, reply);
                    break;
                case Payload.Commissioning:
                    break; // a program that commissions a device moves no hand
                default:
                    Statistics.CountIgnored();
                    break;
            }
        }

        private void Begin(Welcome welcome)
        {
            lock (gate)
            {
                if (closed) return;
                refusal = "";
                command = sequence = stopId = 0;
                datagramNs = datagramSentNs = 0;
                key = welcome.UdpKey;
                holdsControls = welcome.Controls;
                Statistics.BeginConversation();
                if (welcome.UdpPort != 0) OpenDatagrams(welcome.UdpPort);
                connected = true;
                Keep(MonotonicClock.NowNs());
            }
            RaiseConnection(true, "connected to Wholehand " + welcome.ProgramVersion);
        }

        // ---- states ----

        private readonly object showing = new object(); // serializes two threads that report states

        private bool Show(byte[] bytes, int offset, int length, long nowNs)
        {
            lock (showing)
            {
                filling.CopyFrom(bytes, offset, length, nowNs);
                if (!Words.IsMessage(filling.Bytes, length)
                    || Message.GetRootAsMessage(filling.Bytes).PayloadType != Payload.WorldState)
                {
                    Statistics.CountIgnored();
                    return false;
                }
                lock (gate)
                {
                    MessageBuffer old = newest;
                    newest = filling;
                    filling = old;
                    haveState = true;
                }
                var received = StateReceived;
                if (received == null || options.Polled) return true;
                try
                {
                    // Nobody writes to it before the next state but one.
                    received(Words.StateOf(newest.Bytes));
                }
                catch (Exception e)
                {
                    Guard(() => { throw e; });
                }
                return true;
            }
        }

        private void Raise<T>(Action<T> handler, T argument)
        {
            if (handler != null) Raise(() => handler(argument));
        }
    }
}
