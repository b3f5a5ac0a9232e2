using System;
using System.Collections.Concurrent;
using System.IO;
using System.Net;
using System.Net.Sockets;
using System.Security.Cryptography;
using System.Text;
using System.Text.RegularExpressions;
using System.Threading;
using FlatBuffers;
using Wholehand;
using wholehand.protocol;

/// <summary>A fake program that a test controls message by message: a WebSocket (RFC 6455) of one client, and
/// datagrams.</summary>
internal sealed class MadeUpProgram : IDisposable
{
    public const ulong Key = 0x1122334455667788;

    public readonly Socket Socket = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp);
    public readonly ConcurrentQueue<byte[]> Heard = new ConcurrentQueue<byte[]>(); // messages except heartbeats
    public uint Sequence, Rate, StopSeen;
    public EndPoint Client;
    public volatile int Heartbeats; // received by WebSocket
    private readonly TcpListener listener = new TcpListener(IPAddress.Loopback, 0);
    private readonly byte[] buffer = new byte[2000];
    private TcpClient line;
    private Thread life;
    private volatile bool lives;

    public MadeUpProgram()
    {
        Socket.Bind(new IPEndPoint(IPAddress.Loopback, 0));
        Socket.ReceiveTimeout = 20000;
        listener.Start();
        Port = ((IPEndPoint)listener.LocalEndpoint).Port;
    }

    public int Port { get; private set; }

    // ---- the WebSocket ----

    /// <summary>Takes the next connection and welcomes it.</summary>
    public void Welcome()
    {
        // Drops messages of an earlier conversation.
        EndPoint from = new IPEndPoint(IPAddress.Any, 0);
        while (Socket.Available > 0) Socket.ReceiveFrom(buffer, ref from);
        line = listener.AcceptTcpClient();
        Stream stream = line.GetStream();
        var head = new StringBuilder();
        while (!head.ToString().EndsWith("\r\n\r\n")) head.Append((char)stream.ReadByte());
        string key = Regex.Match(head.ToString(), @"Sec-WebSocket-Key: (\S+)", RegexOptions.IgnoreCase).Groups[1].Value;
        string accept = Convert.ToBase64String(SHA1.Create().ComputeHash(
            Encoding.ASCII.GetBytes(key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11")));
        byte[] answer = Encoding.ASCII.GetBytes("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
            + "Connection: Upgrade\r\nSec-WebSocket-Accept: " + accept + "\r\n\r\n");
        stream.Write(answer, 0, answer.Length);
        new Thread(() => Listen(stream)) { IsBackground = true }.Start();
        var b = new FlatBufferBuilder(64);
        StringOffset version = b.CreateString("made up");
        int port = ((IPEndPoint)Socket.LocalEndPoint).Port;
        Tell(Finished(b, Payload.Welcome,
            wholehand.protocol.Welcome.CreateWelcome(b, 1, 9, false, version, (ushort)port, Key).Value));
        // Sends signs of life, as a program does.
        lives = true;
        life = new Thread(Live) { IsBackground = true };
        life.Start();
    }

    private void Live()
    {
        var b = new FlatBufferBuilder(64);
        byte[] controls = Finished(b, Payload.Controls, Controls.CreateControls(b).Value);
        try
        {
            for (; lives; Thread.Sleep(50)) Tell(controls);
        }
        catch (Exception e) when (e is IOException || e is InvalidOperationException)
        {
            // The client has closed the connection.
        }
    }

    /// <summary>Sends nothing any more, but keeps the connection.</summary>
    public void FallSilent()
    {
        lives = false;
        if (life != null) life.Join();
    }

    public void Tell(byte[] message)
    {
        var frame = new MemoryStream();
        frame.WriteByte(0x82);
        if (message.Length < 126) frame.WriteByte((byte)message.Length);
        else frame.Write(new byte[] { 126, (byte)(message.Length >> 8), (byte)message.Length }, 0, 3);
        frame.Write(message, 0, message.Length);
        lock (listener) line.GetStream().Write(frame.ToArray(), 0, (int)frame.Length);
    }

    private static byte[] Take(Stream stream, int count)
    {
        var bytes = new byte[count];
        for (int n = 0; n < count;)
        {
            int more = stream.Read(bytes, n, count - n);
            if (more <= 0) throw new IOException();
            n += more;
        }
        return bytes;
    }

    private void Listen(Stream stream)
    {
        try
        {
            while (true)
            {
                byte[] head = Take(stream, 2);
                int length = head[1] & 127;
                if (length == 126)
                {
                    byte[] more = Take(stream, 2);
                    length = more[0] << 8 | more[1];
                }
                byte[] mask = Take(stream, 4), message = Take(stream, length);
                for (int i = 0; i < length; ++i) message[i] ^= mask[i % 4];
                if ((head[0] & 15) != 2) continue;
                if (CommandOf(message).OrderType == Order.Heartbeat) ++Heartbeats;
                else Heard.Enqueue(message);
            }
        }
        catch (Exception e) when (e is IOException || e is ObjectDisposedException)
        {
        }
    }

    public static Command CommandOf(byte[] message)
    {
        return Message.GetRootAsMessage(new ByteBuffer(message)).PayloadAsCommand();
    }

    public Command HearCommand()
    {
        byte[] message = null;
        Check.Until(() => Heard.TryDequeue(out message), "a command by WebSocket");
        return CommandOf(message);
    }

    public void TellReply(uint command, bool accepted, string reason)
    {
        var b = new FlatBufferBuilder(64);
        Tell(Finished(b, Payload.Reply, Reply.CreateReply(b, command, accepted, b.CreateString(reason)).Value));
    }

    // ---- datagrams ----

    /// <summary>The next datagram of that kind, and its command if it has one.</summary>
    public DatagramHeader HearA(DatagramKind kind, out Command command)
    {
        while (true)
        {
            EndPoint from = new IPEndPoint(IPAddress.Any, 0);
            int size = Socket.ReceiveFrom(buffer, ref from);
            Client = from;
            Check.Equal(DatagramFlaw.None, Datagram.Read(buffer, size, out DatagramHeader header), "the client's datagram");
            Check.Equal(Key, header.Key, "key");
            Check.True(header.Sequence > Sequence, "numbers rise");
            Sequence = header.Sequence;
            Rate = header.RateOrStop;
            command = new Command();
            if (header.Kind != kind) continue;
            var payload = new byte[size - Datagram.HeaderSize];
            Buffer.BlockCopy(buffer, Datagram.HeaderSize, payload, 0, payload.Length);
            if (kind == DatagramKind.Command) command = CommandOf(payload);
            return header;
        }
    }

    public DatagramHeader HearAlive()
    {
        return HearA(DatagramKind.Alive, out Command ignored);
    }

    public static byte[] Finished(FlatBufferBuilder b, Payload type, int payload, ushort schema = 1)
    {
        Message.FinishMessageBuffer(b, Message.CreateMessage(b, schema, type, payload));
        return b.SizedByteArray();
    }

    public static byte[] StateMessage(ulong tick)
    {
        var b = new FlatBufferBuilder(256);
        VectorOffset q = WorldState.CreateQSVector(b, new[] { 0.5f, -0.25f });
        WorldState.StartWorldState(b);
        WorldState.AddTick(b, tick);
        WorldState.AddQS(b, q);
        return Finished(b, Payload.WorldState, WorldState.EndWorldState(b).Value);
    }

    public static byte[] Written(DatagramKind kind, ulong key, uint sequence, byte[] payload, uint stopSeen = 0)
    {
        var header = new DatagramHeader
        {
            Kind = kind, Key = key, Sequence = sequence, SentNs = MonotonicClock.NowNs(), RateOrStop = stopSeen
        };
        return DatagramTests.Written(header, payload);
    }

    public void SayBytes(byte[] bytes)
    {
        Socket.SendTo(bytes, Client);
    }

    public void Say(DatagramKind kind, uint sequence, byte[] payload)
    {
        SayBytes(Written(kind, Key, sequence, payload, StopSeen));
    }

    public void Dispose()
    {
        FallSilent();
        listener.Stop();
        if (line != null) line.Close();
        Socket.Close();
    }
}
