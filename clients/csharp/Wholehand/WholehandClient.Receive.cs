using System;
using System.Net.Sockets;
using System.Text;
using System.Threading;
using wholehand.protocol;

namespace Wholehand
{
    // The thread that receives.
    public sealed partial class WholehandClient
    {
        private void ReceiveLoop()
        {
            // One byte more than is allowed tells what is too long.
            var bytes = new byte[Datagram.LargestSize + 1];
            while (!closed)
            {
                int size;
                try
                {
                    size = socket.Receive(bytes);
                }
                catch (SocketException e)
                {
                    if (closed) return;
                    if (e.SocketErrorCode == SocketError.MessageSize) Statistics.CountIgnored();
                    // Nobody listens there at present: the system says so at once, again and again.
                    else if (e.SocketErrorCode != SocketError.TimedOut && e.SocketErrorCode != SocketError.WouldBlock)
                    {
                        Thread.Sleep(10);
                    }
                    continue;
                }
                catch (ObjectDisposedException)
                {
                    return;
                }
                Receive(bytes, size, MonotonicClock.NowNs());
            }
        }

        // Any bytes of the connected address. Tests call it, too.
        internal void Receive(byte[] bytes, int size, long nowNs)
        {
            DatagramHeader header;
            if (Datagram.Read(bytes, size, out header) != DatagramFlaw.None)
            {
                Statistics.CountIgnored();
                return;
            }
            try
            {
                if (header.Kind == DatagramKind.Welcome) ReceiveWelcome(header, bytes, nowNs);
                else if (header.Kind == DatagramKind.Refused) ReceiveRefusal(header, bytes);
                else if (header.Session == 0 || header.Session != CurrentSession()) Statistics.CountIgnored();
                else ReceiveInConversation(header, bytes, nowNs);
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

        private uint CurrentSession()
        {
            lock (gate) return session;
        }

        private void ReceiveInConversation(DatagramHeader header, byte[] bytes, long nowNs)
        {
            lock (gate) heardNs = nowNs;
            switch (header.Kind)
            {
                case DatagramKind.State:
                    ReceiveState(header, bytes, nowNs);
                    break;
                case DatagramKind.Reliable:
                    ReceiveReliable(header, bytes);
                    break;
                case DatagramKind.Goodbye:
                    lock (gate) EndConversation("the program has ended");
                    RaiseConnection(false, "the program has ended");
                    break;
                case DatagramKind.Heartbeat:
                    break;
                default:
                    Statistics.CountIgnored();
                    break;
            }
        }

        private static bool IsMessage(MessageAssembler message, Payload type)
        {
            if (message.Length < 8 || !Message.MessageBufferHasIdentifier(message.Bytes)) return false;
            Message m = Message.GetRootAsMessage(message.Bytes);
            return m.SchemaVersion == Words.SchemaVersion && (type == Payload.NONE || m.PayloadType == type)
                && Words.HasPayload(message.Bytes);
        }

        private void ReceiveWelcome(DatagramHeader header, byte[] bytes, long nowNs)
        {
            var message = new MessageAssembler(Datagram.LargestPayload, Datagram.LargestPayload);
            if (header.Session == 0 || message.Add(header, bytes) != MessageAssembler.Result.Complete
                || !IsMessage(message, Payload.Welcome))
            {
                Statistics.CountIgnored();
                return;
            }
            Welcome welcome = Message.GetRootAsMessage(message.Bytes).PayloadAsWelcome();
            lock (gate)
            {
                if (session != 0) return; // of a Hello that was repeated
                session = header.Session;
                refusal = "";
                heardNs = nowNs;
                inbox = new ReliableInbox();
                Statistics.BeginConversation();
                holdsControls = welcome.Controls;
                SendWhatIsDue(nowNs);
            }
            RaiseConnection(true, "connected to Wholehand " + welcome.ProgramVersion);
        }

        private void ReceiveRefusal(DatagramHeader header, byte[] bytes)
        {
            string why = Encoding.UTF8.GetString(bytes, Datagram.HeaderSize, header.PayloadLength);
            lock (gate)
            {
                if (session != 0 || refusal == why) return;
                refusal = why;
            }
            RaiseConnection(false, why);
        }

        private void ReceiveState(DatagramHeader header, byte[] bytes, long nowNs)
        {
            if (!Statistics.IsNewer(header.Sequence)) return;
            MessageAssembler.Result result = filling.Add(header, bytes);
            if (result == MessageAssembler.Result.Incomplete) return;
            if (result != MessageAssembler.Result.Complete || !IsMessage(filling, Payload.WorldState))
            {
                Statistics.CountIgnored();
                return;
            }
            Statistics.Count(header.Sequence, nowNs - header.MonotonicNs);
            lock (gate)
            {
                MessageAssembler old = newest;
                newest = filling;
                filling = old;
                haveState = true;
            }
            var received = StateReceived;
            if (received == null || options.Polled) return;
            try
            {
                // Nobody but this thread writes to it, and not before the next state but one.
                received(Words.StateOf(newest.Bytes));
            }
            catch (Exception e)
            {
                Guard(() => { throw e; });
            }
        }

        private void ReceiveReliable(DatagramHeader header, byte[] bytes)
        {
            lock (gate)
            {
                if (!inbox.Add(header, bytes)) return;
                Send(DatagramKind.Message, Words.Acknowledge(builder, header.Sequence));
            }
            while (true)
            {
                MessageAssembler message;
                lock (gate) message = inbox.Take();
                if (message == null) return;
                if (IsMessage(message, Payload.NONE)) Deliver(Message.GetRootAsMessage(message.Bytes));
                else Statistics.CountIgnored();
            }
        }

        private void Deliver(Message message)
        {
            switch (message.PayloadType)
            {
                case Payload.Scene:
                    Scene newScene = message.PayloadAsScene();
                    lock (gate) scene = newScene;
                    Raise(SceneReceived, newScene);
                    break;
                case Payload.Events:
                    Raise(EventsReceived, message.PayloadAsEvents());
                    break;
                case Payload.Controls:
                    Controls controls = message.PayloadAsControls();
                    holdsControls = controls.HeldByYou;
                    Raise(ControlsChanged, controls);
                    break;
                case Payload.Reply:
                    Reply reply = message.PayloadAsReply();
                    lock (gate)
                    {
                        commands.Answer(reply.Command, new CommandReply(reply.Accepted, reply.Reason));
                        SendWhatIsDue(MonotonicClock.NowNs());
                    }
                    Raise(ReplyReceived, reply);
                    break;
                default:
                    Statistics.CountIgnored();
                    break;
            }
        }

        private void Raise<T>(Action<T> handler, T argument)
        {
            if (handler != null) Raise(() => handler(argument));
        }
    }
}
