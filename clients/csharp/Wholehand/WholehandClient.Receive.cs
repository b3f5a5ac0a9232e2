using System;
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
    // What the program says on the WebSocket, on a thread of its own.
    public sealed partial class WholehandClient
    {
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

        // From connecting to the end; in words why it ended.
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

        // A WebSocket does not report why it was refused: a plain request does.
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
                // FlatBuffers looked where nothing is: a message that another program made.
                Statistics.CountIgnored();
            }
        }

        private static bool IsOfRubbish(Exception e)
        {
            return e is ArgumentException || e is IndexOutOfRangeException || e is InvalidOperationException
                || e is OverflowException;
        }

        private ByteBuffer inPlace = new ByteBuffer(new byte[8]);
        private byte[] inPlaceBytes; // of inPlace

        // Any bytes of the WebSocket. Tests call it, too.
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
                // At 0 Hz datagrams bring no states.
                if (options.RateHz == 0 || !DatagramsCome(nowNs)) Show(bytes, 0, length, nowNs);
                return;
            }
            // Handlers may keep what they are given.
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
                    break; // a program that leads through one moves no hand
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

        private readonly object showing = new object(); // of two threads, one at a time

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
