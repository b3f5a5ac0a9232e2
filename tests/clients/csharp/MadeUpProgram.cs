using System;
using System.Net;
using System.Net.Sockets;
using System.Threading;
using FlatBuffers;
using Wholehand;
using wholehand.protocol;

/// <summary>The program's side of a conversation, said word by word by a test.</summary>
internal sealed class MadeUpProgram : IDisposable
{
    public readonly Socket Socket = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp);
    public uint Session = 77, States, Reliables;
    public EndPoint Client;
    public volatile bool Alive; // it says so, as a program does
    private readonly Timer heartbeat;
    private readonly byte[] buffer = new byte[2000];

    public MadeUpProgram()
    {
        Socket.Bind(new IPEndPoint(IPAddress.Loopback, 0));
        Socket.ReceiveTimeout = 5000;
        Port = ((IPEndPoint)Socket.LocalEndPoint).Port;
        heartbeat = new Timer(ignored => { if (Alive) Say(DatagramKind.Heartbeat, 1, new byte[0]); }, null, 50, 50);
    }

    public int Port { get; private set; }

    public DatagramHeader Hear()
    {
        EndPoint from = new IPEndPoint(IPAddress.Any, 0);
        int size = Socket.ReceiveFrom(buffer, ref from);
        Client = from;
        DatagramHeader header;
        Check.Equal(DatagramFlaw.None, Datagram.Read(buffer, size, out header), "the client's datagram");
        return header;
    }

    /// <summary>Hears until something of that kind comes.</summary>
    public DatagramHeader HearA(DatagramKind kind)
    {
        while (true)
        {
            DatagramHeader header = Hear();
            if (header.Kind == kind) return header;
        }
    }

    public void Welcome()
    {
        HearA(DatagramKind.Hello);
        var b = new FlatBufferBuilder(64);
        StringOffset version = b.CreateString("made up");
        int welcome = wholehand.protocol.Welcome.CreateWelcome(b, 1, 9, false, version).Value;
        Say(DatagramKind.Welcome, 1, Finished(b, Payload.Welcome, welcome));
        Alive = true;
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

    public static byte[] Datagrams(DatagramKind kind, uint session, uint sequence, byte[] payload)
    {
        var header = new DatagramHeader
        {
            Kind = kind, Session = session, Sequence = sequence, MonotonicNs = MonotonicClock.NowNs(), FragmentCount = 1
        };
        return DatagramTests.Fragments(header, payload)[0];
    }

    public void Say(DatagramKind kind, uint sequence, byte[] payload)
    {
        SayBytes(Datagrams(kind, Session, sequence, payload));
    }

    public void SayBytes(byte[] bytes)
    {
        Socket.SendTo(bytes, Client);
    }

    public void SayState(ulong tick)
    {
        Say(DatagramKind.State, ++States, StateMessage(tick));
    }

    public void Dispose()
    {
        Alive = false;
        using (var ended = new ManualResetEvent(false))
        {
            if (heartbeat.Dispose(ended)) ended.WaitOne();
        }
        Socket.Close();
    }
}
