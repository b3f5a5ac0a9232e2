using System;
using System.Net.Sockets;
using System.Threading;
using wholehand.protocol;

namespace Wholehand
{
    // Receives the program's datagrams on a thread of its own.
    public sealed partial class WholehandClient
    {
        private void OpenDatagrams(int port)
        {
            var socket = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp);
            // A buffer for datagrams that come while this process is delayed for a second or more.
            socket.ReceiveBufferSize = 4 * 1024 * 1024;
            socket.ReceiveTimeout = 200;
            // On a connected socket the system drops datagrams of other senders, and receiving allocates nothing.
            socket.Connect(options.Host, port);
            datagrams = socket;
            new Thread(() => ReceiveDatagrams(socket)) { IsBackground = true, Name = "Wholehand datagrams" }.Start();
        }

        private void ReceiveDatagrams(Socket socket)
        {
            // One byte more than the limit detects datagrams that are too long.
            var bytes = new byte[Datagram.LargestSize + 1];
            while (!closed && socket == datagrams)
            {
                try
                {
                    Receive(bytes, socket.Receive(bytes), MonotonicClock.NowNs());
                }
                catch (SocketException e)
                {
                    if (e.SocketErrorCode == SocketError.MessageSize) Statistics.CountIgnored();
                    // Nobody listens there at present: the system reports that at once, for every send.
                    else if (e.SocketErrorCode != SocketError.TimedOut && e.SocketErrorCode != SocketError.WouldBlock)
                    {
                        Thread.Sleep(PaceMs);
                    }
                }
                catch (ObjectDisposedException)
                {
                    return;
                }
            }
        }

        // Processes any bytes from the connected address. Tests call it, too.
        internal void Receive(byte[] bytes, int size, long nowNs)
        {
            DatagramHeader header;
            if (Datagram.Read(bytes, size, out header) != DatagramFlaw.None || header.Key != key
                || (header.Kind != DatagramKind.State && header.Kind != DatagramKind.Present))
            {
                Statistics.CountIgnored();
                return;
            }
            if (!Statistics.IsNewer(header.Sequence)) return;
            lock (gate)
            {
                datagramNs = nowNs;
                datagramSentNs = header.SentNs;
                if (stopMessage != null && header.RateOrStop == stopId) Answer(stopId, new CommandReply(true, ""));
            }
            if (header.EchoNs != 0) Statistics.CountRoundTrip(nowNs - header.EchoNs - header.EchoAgeUs * 1000L);
            if (header.Kind != DatagramKind.State) return;
            try
            {
                if (Show(bytes, Datagram.HeaderSize, size - Datagram.HeaderSize, nowNs))
                {
                    Statistics.CountState(nowNs - header.SentNs);
                }
            }
            catch (Exception e) when (IsOfRubbish(e))
            {
                Statistics.CountIgnored();
            }
        }

        private bool DatagramsCome(long nowNs)
        {
            lock (gate) return datagrams != null && datagramNs != 0 && nowNs - datagramNs < DatagramsGoneNs;
        }
    }
}
