using System;
using System.Threading;
using FlatBuffers;
using Wholehand;
using wholehand.protocol;

/// <summary>The client with a fake program, which may also send invalid messages.</summary>
[Tests]
public static class ClientTests
{
    private static WholehandClient Connected(MadeUpProgram program, bool polled = false)
    {
        var client = new WholehandClient(new ClientOptions { Port = program.Port, Polled = polled });
        client.Connect();
        program.Welcome();
        Check.Until(() => client.Connected, "connected");
        if (!polled) program.HearAlive();
        return client;
    }

    public static void States_AreCopiedAndCounted()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            Check.Equal(1000u, program.Rate, "the rate that it asks for");
            var state = new HandState();
            Check.True(!client.TryGetState(state), "there is none yet");
            program.Say(DatagramKind.State, 1, MadeUpProgram.StateMessage(41));
            Check.Until(() => client.TryGetState(state), "a state");
            Check.Equal(41UL, state.Tick, "tick");
            Check.Equal(2, state.HandPosition.Length, "axes");
            Check.Equal(-0.25f, state.HandPosition[1], "second axis");
            Check.True(!client.TryGetState(state), "no newer one");
            program.Say(DatagramKind.Present, 2, new byte[0]);
            program.Say(DatagramKind.State, 6, MadeUpProgram.StateMessage(45));
            Check.Until(() => client.TryGetState(state), "another");
            Check.Equal(3L, client.Statistics.Lost, "lost");
            program.Say(DatagramKind.State, 5, MadeUpProgram.StateMessage(42));
            program.Say(DatagramKind.State, 6, MadeUpProgram.StateMessage(45));
            Check.Until(() => client.Statistics.OutOfOrder == 2, "an old one, and one that came twice");
            Check.True(!client.TryGetState(state), "are not shown");
        }
    }

    public static void Datagrams_EchoTheProgramsLastDatagram()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            byte[] said = MadeUpProgram.Written(DatagramKind.Present, MadeUpProgram.Key, 1, new byte[0]);
            program.SayBytes(said);
            long sent = DatagramTests.HeaderOf(said).SentNs;
            Check.Until(() => program.HearAlive().EchoNs == sent, "echoed");
        }
    }

    public static void StatesAndAimsWithoutDatagrams_UseTheWebSocket()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            var state = new HandState();
            program.Tell(MadeUpProgram.StateMessage(7));
            Check.Until(() => client.TryGetState(state) && state.Tick == 7, "a state");
            client.Aim(new[] { 0.5f });
            Check.Equal(Order.Aim, program.HearCommand().OrderType, "an aim");
            program.Say(DatagramKind.State, 1, MadeUpProgram.StateMessage(8));
            Check.Until(() => client.TryGetState(state) && state.Tick == 8, "a state by datagram");
            client.Aim(new[] { 0.5f });
            program.HearA(DatagramKind.Command, out Command command);
            Check.Equal(Order.Aim, command.OrderType, "an aim by datagram");
        }
    }

    public static void MalformedDatagrams_AreCountedAndIgnored()
    {
        var random = new Random(Runner.Seed);
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            int handled = 0;
            client.SceneReceived += s => ++handled;
            client.EventsReceived += e => ++handled;
            client.StateReceived += s => ++handled;
            byte[] good = MadeUpProgram.Written(DatagramKind.State, MadeUpProgram.Key, 1000,
                MadeUpProgram.StateMessage(1));
            long expected = 0;
            Action<byte[]> bad = bytes =>
            {
                program.SayBytes(bytes);
                ++expected;
                long wanted = expected;
                Check.Until(() => client.Statistics.Ignored == wanted, "counted");
            };
            bad(new byte[0]);
            bad(new byte[1201]);
            bad(new byte[1999]);
            var damaged = (byte[])good.Clone();
            damaged[60] ^= 4;
            bad(damaged);
            // Valid datagrams with contents that no program sends.
            byte[] state = MadeUpProgram.StateMessage(1);
            bad(MadeUpProgram.Written(DatagramKind.State, MadeUpProgram.Key + 1, 1000, state));
            bad(MadeUpProgram.Written(DatagramKind.Alive, MadeUpProgram.Key, 1000, new byte[0]));
            bad(MadeUpProgram.Written(DatagramKind.State, MadeUpProgram.Key, 1000, new byte[3]));
            bad(MadeUpProgram.Written(DatagramKind.State, MadeUpProgram.Key, 1001, new byte[100])); // no identifier
            var b = new FlatBufferBuilder(64);
            bad(MadeUpProgram.Written(DatagramKind.State, MadeUpProgram.Key, 1002, // another schema
                MadeUpProgram.Finished(b, Payload.Controls, Controls.CreateControls(b).Value, 2)));
            for (int i = 0; i < 300; ++i)
            {
                // The identifier is right, the rest is not: offsets point anywhere.
                var rubbish = new byte[12 + random.Next(200)];
                random.NextBytes(rubbish);
                rubbish[4] = (byte)'W';
                rubbish[5] = (byte)'H';
                rubbish[6] = (byte)'N';
                rubbish[7] = (byte)'D';
                if (i % 2 == 0) program.Say(DatagramKind.State, 2000u + (uint)i, rubbish);
                else program.Tell(rubbish);
            }
            var shown = new HandState();
            Check.Until(() =>
            {
                // Repeated until it is counted: a datagram may be lost, and a repeated one counts once.
                program.Say(DatagramKind.State, 9000, MadeUpProgram.StateMessage(7));
                return client.TryGetState(shown) && shown.Tick == 7 && handled > 0;
            }, "the client goes on");
            Check.True(client.Connected, "connected");
            Check.Equal(1, handled, "nothing but the state was reported");
        }
    }

    public static void States_AllocateNothing()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            program.FallSilent(); // messages over the WebSocket allocate
            byte[] datagram = MadeUpProgram.Written(DatagramKind.State, MadeUpProgram.Key, 1, MadeUpProgram.StateMessage(1));
            DatagramHeader header = DatagramTests.HeaderOf(datagram);
            var payload = new byte[datagram.Length - Datagram.HeaderSize];
            Buffer.BlockCopy(datagram, Datagram.HeaderSize, payload, 0, payload.Length);
            var state = new HandState();
            const uint States = 10000;
            long allocated = 0;
            for (uint i = 1; i <= States + 1000; ++i)
            {
                header.Sequence = i;
                int size = Datagram.Write(datagram, header, payload, 0, payload.Length);
                client.Receive(datagram, size, MonotonicClock.NowNs());
                client.TryGetState(state);
                if (i == 1000) allocated = GC.GetAllocatedBytesForCurrentThread(); // all code is compiled and all buffers exist
            }
            Check.Equal(States + 1000L, client.Statistics.Received, "received");
            Check.Equal(0L, GC.GetAllocatedBytesForCurrentThread() - allocated, "bytes allocated");
        }
    }

    private static byte[] WorldMessage(ulong tick, int bodies, int contacts)
    {
        var b = new FlatBufferBuilder(8192);
        WorldState.StartBodiesVector(b, bodies);
        for (int i = bodies - 1; i >= 0; --i) Pose.CreatePose(b, 0.01f * i, 0.02f * i, 0.5f, 0, 0, 0, 1);
        VectorOffset poses = b.EndVector();
        WorldState.StartContactsVector(b, contacts);
        for (int i = 0; i < contacts; ++i) ContactPoint.CreateContactPoint(b, 1, (short)i, 0, 0, 0, 0, 0, 1);
        VectorOffset points = b.EndVector();
        WorldState.StartWorldState(b);
        WorldState.AddSession(b, 1);
        WorldState.AddTick(b, tick);
        WorldState.AddBodies(b, poses);
        WorldState.AddContacts(b, points);
        return MadeUpProgram.Finished(b, Payload.WorldState, WorldState.EndWorldState(b).Value);
    }

    private static byte[] BodiesMessage(uint bodies)
    {
        var b = new FlatBufferBuilder(2048);
        GameBodies.StartBodiesVector(b, (int)bodies);
        for (uint i = bodies; i > 0; --i) GameBody.CreateGameBody(b, i - 1, 7, 3, SlotState.Solid);
        return MadeUpProgram.Finished(b, Payload.GameBodies, GameBodies.CreateGameBodies(b, 1, b.EndVector()).Value);
    }

    public static void StatesOf64Bodies_AllocateNothing()
    {
        using (var client = new WholehandClient(new ClientOptions { RateHz = 0 }))
        {
            var messages = new[] { WorldMessage(1, 64, 40), WorldMessage(2, 64, 30) };
            byte[] of64 = BodiesMessage(64);
            client.Hear(of64, of64.Length, 1);
            var incoming = new byte[64 * 1024]; // as large as the buffer of the listening thread
            var hand = new HandState();
            var world = new WorldSnapshot();
            var slots = new BodySlots();
            const int States = 10000;
            long allocated = 0;
            int copies = 0;
            double sum = 0;
            for (int i = 0; i < States + 1000; ++i)
            {
                byte[] message = messages[i % 2];
                Buffer.BlockCopy(message, 0, incoming, 0, message.Length);
                client.Hear(incoming, message.Length, MonotonicClock.NowNs());
                if (client.TryGetState(hand) && client.TryGetWorld(world)) ++copies;
                slots.Number = 0; // forces a new copy, as if the list had changed
                client.TryGetBodies(slots);
                for (int s = 0; s < slots.Count; ++s) sum += world.BodyPositions[slots.PoseOf(slots.Bodies[s].Slot)].X;
                if (i == 1000) allocated = GC.GetAllocatedBytesForCurrentThread();
            }
            allocated = GC.GetAllocatedBytesForCurrentThread() - allocated;
            Check.Equal(States + 1000, copies, "copies");
            Check.Equal(64, slots.Count, "bodies");
            Check.Near(0.01 * 64 * 63 / 2 * (States + 1000), sum, 1e-5 * sum, "what was read");
            Check.Equal(0L, allocated, "bytes that were allocated after the first 1000 states");
        }
    }

    public static void PolledClient_RaisesEventsInPollAndIsSilentWithoutIt()
    {
        using (var program = new MadeUpProgram())
        using (var client = new WholehandClient(new ClientOptions { Port = program.Port, Polled = true }))
        {
            int thread = 0;
            string version = "";
            client.ConnectionChanged += (connected, why) =>
            {
                thread = Thread.CurrentThread.ManagedThreadId;
                version = why;
            };
            client.Connect();
            program.Welcome();
            Check.Until(() => client.Connected, "connected");
            Check.Equal("", version, "nothing is raised before Poll");
            Check.Until(() => { client.Poll(); return version != ""; }, "raised by Poll");
            Check.Equal(Thread.CurrentThread.ManagedThreadId, thread, "thread");
            client.Poll();
            Check.Until(() => { client.Poll(); return program.Socket.Available > 0; }, "it lives");
            program.HearAlive();
            // The game hangs: the client sends nothing from 100 ms after its last poll. Earlier datagrams are read
            // first.
            Check.Until(() =>
            {
                int before = program.Heartbeats;
                while (program.Socket.Available > 0) program.HearAlive();
                Thread.Sleep(200); // five times the usual interval
                return program.Socket.Available == 0 && program.Heartbeats == before;
            }, "no sign of life while nobody polls");
            Check.True(client.Connected, "connected all the same");
            Check.Until(() => { client.Poll(); return program.Socket.Available > 0; }, "it lives again");
        }
    }

    public static void EmergencyStop_IsSentOnBothLinesUntilAcknowledged()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            var other = client.Action(Act.Pause);
            Check.Equal(Order.Action, program.HearCommand().OrderType, "by WebSocket");
            var stop = client.EmergencyStop();
            Command first = program.HearCommand(), repeated;
            Check.Equal(Order.EmergencyStop, first.OrderType, "by WebSocket");
            for (int i = 0; i < 5; ++i)
            {
                program.HearA(DatagramKind.Command, out repeated);
                Check.Equal(Order.EmergencyStop, repeated.OrderType, "by datagram, again and again");
                Check.Equal(first.Id, repeated.Id, "under the same number");
            }
            Check.True(!stop.IsCompleted, "nobody has seen it");
            program.StopSeen = first.Id;
            program.Say(DatagramKind.Present, 1, new byte[0]);
            Check.Until(() => stop.IsCompleted, "seen");
            Check.True(stop.Result.Accepted, "accepted");
            Check.True(!other.IsCompleted, "the other waits for its own answer");
            program.TellReply(1, false, "stopped");
            Check.Until(() => other.IsCompleted, "answered");
            Check.Equal("stopped", other.Result.Reason, "in words");
        }
    }

    public static void ArmBeforeTheFirstState_IsRefusedWithTheReason()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            CommandReply early = client.Arm(1, 1).Result;
            Check.True(!early.Accepted && early.Reason.Contains("no state has come yet"), early.Reason);
            program.Say(DatagramKind.State, 1, MadeUpProgram.StateMessage(5));
            var state = new HandState();
            Check.Until(() => client.TryGetState(state), "a state");
            client.Arm(1, 1);
            Check.Equal(Order.Arm, program.HearCommand().OrderType, "it is asked now");
        }
    }

    public static void SilentProgram_IsLostAndFoundAgain()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            var waits = client.Action(Act.Pause);
            program.FallSilent();
            Check.Until(() => !client.Connected, "lost after two seconds");
            Check.Until(() => waits.IsCompleted && !waits.Result.Accepted, "what waits is given up");
            Check.True(!client.Arm(1, 1).Result.Accepted, "commands are refused meanwhile");
            program.Sequence = 0;
            program.Welcome();
            Check.Until(() => client.Connected, "found again");
            program.HearAlive();
            program.Say(DatagramKind.State, 1, MadeUpProgram.StateMessage(5));
            var state = new HandState();
            Check.Until(() => client.TryGetState(state) && state.Tick == 5, "a state of the new conversation");
        }
    }

    public static void HandlerThatThrows_IsReportedAndTheClientContinues()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            string reported = "";
            client.HandlerThrew += e => reported = e.Message;
            client.StateReceived += s => { throw new InvalidOperationException("of the game"); };
            program.Say(DatagramKind.State, 1, MadeUpProgram.StateMessage(1));
            Check.Until(() => reported == "of the game", "reported");
            program.Say(DatagramKind.State, 2, MadeUpProgram.StateMessage(2));
            Check.Until(() => client.Statistics.Received == 2, "goes on");
            Check.Equal(0L, client.Statistics.Ignored, "the program is not blamed");
        }
    }

    public static void ImpossibleOptions_AreRefused()
    {
        foreach (ClientOptions options in new[]
        {
            new ClientOptions { RateHz = -1 }, new ClientOptions { RateHz = 1001 },
            new ClientOptions { Token = "two\r\nlines" }
        })
        {
            try
            {
                new WholehandClient(options).Dispose();
            }
            catch (ArgumentException)
            {
                continue;
            }
            throw new Failure("accepted");
        }
    }
}
