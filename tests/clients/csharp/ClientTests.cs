using System;
using System.Threading;
using FlatBuffers;
using Wholehand;
using wholehand.protocol;

/// <summary>The client against a program made up here, which may also say what no program should.</summary>
[Tests]
public static class ClientTests
{
    private static WholehandClient Connected(MadeUpProgram program, bool polled = false)
    {
        var client = new WholehandClient(new ClientOptions { Port = program.Port, Polled = polled });
        client.Connect();
        program.Welcome();
        Check.Until(() => client.Connected, "connected");
        return client;
    }

    public static void States_AreCopiedAndCounted()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            var state = new HandState();
            Check.True(!client.TryGetState(state), "there is none yet");
            program.SayState(41);
            Check.Until(() => client.TryGetState(state), "a state");
            Check.Equal(41UL, state.Tick, "tick");
            Check.Equal(2, state.HandPosition.Length, "axes");
            Check.Equal(-0.25f, state.HandPosition[1], "second axis");
            Check.True(!client.TryGetState(state), "no newer one");
            program.States += 3;
            program.SayState(45);
            Check.Until(() => client.TryGetState(state), "another");
            Check.Equal(3L, client.Statistics.Lost, "lost");
            program.Say(DatagramKind.State, 2, MadeUpProgram.StateMessage(42));
            Check.Until(() => client.Statistics.OutOfOrder == 1, "an old one");
            Check.True(!client.TryGetState(state), "an old one is not shown");
        }
    }

    public static void MalformedDatagrams_AreCountedAndHarmNothing()
    {
        var random = new Random(Runner.Seed);
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            int handled = 0;
            client.SceneReceived += s => ++handled;
            client.EventsReceived += e => ++handled;
            client.StateReceived += s => ++handled;
            byte[] good = MadeUpProgram.Datagrams(DatagramKind.State, 77, 1000, MadeUpProgram.StateMessage(1));
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
            // Sound datagrams with what no program says.
            bad(MadeUpProgram.Datagrams(DatagramKind.State, 78, 1000, MadeUpProgram.StateMessage(1))); // another session
            bad(MadeUpProgram.Datagrams(DatagramKind.Hello, 77, 1000, new byte[0]));
            bad(MadeUpProgram.Datagrams(DatagramKind.State, 77, 1000, new byte[3]));
            bad(MadeUpProgram.Datagrams(DatagramKind.State, 77, 1001, new byte[100])); // no identifier
            var scene = new FlatBufferBuilder(64);
            bad(MadeUpProgram.Datagrams(DatagramKind.State, 77, 1002, // another schema
                MadeUpProgram.Finished(scene, Payload.Acknowledge, Acknowledge.CreateAcknowledge(scene, 1).Value, 2)));
            for (int i = 0; i < 300; ++i)
            {
                // The identifier is right, the rest is not: offsets lead anywhere.
                var rubbish = new byte[12 + random.Next(200)];
                random.NextBytes(rubbish);
                rubbish[4] = (byte)'W';
                rubbish[5] = (byte)'H';
                rubbish[6] = (byte)'N';
                rubbish[7] = (byte)'D';
                program.Say(i % 2 == 0 ? DatagramKind.State : DatagramKind.Reliable,
                    i % 2 == 0 ? 2000u + (uint)i : ++program.Reliables, rubbish);
            }
            program.Say(DatagramKind.State, 9000, MadeUpProgram.StateMessage(7));
            var state = new HandState();
            Check.Until(() => client.TryGetState(state) && state.Tick == 7, "the client goes on");
            Check.True(client.Connected, "connected");
            Check.Equal(1, handled, "nothing but the state was told");
        }
    }

    public static void States_CostNoMemory()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            byte[] datagram = MadeUpProgram.Datagrams(DatagramKind.State, 77, 1, MadeUpProgram.StateMessage(1));
            var header = DatagramTests.HeaderOf(datagram);
            var payload = new byte[header.PayloadLength];
            Buffer.BlockCopy(datagram, Datagram.HeaderSize, payload, 0, payload.Length);
            var state = new HandState();
            const int States = 200000;
            int collections = 0;
            for (uint i = 1; i <= States + 1000; ++i)
            {
                header.Sequence = i;
                header.MonotonicNs = i; // another state than before
                int size = Datagram.Write(datagram, header, payload, 0, payload.Length);
                client.Receive(datagram, size, MonotonicClock.NowNs());
                client.TryGetState(state);
                if (i == 1000) collections = GC.CollectionCount(0); // everything is compiled and in place
            }
            Check.Equal((long)States + 1000, client.Statistics.Received, "received");
            // The youngest generation holds 4 MB: 24 bytes a state, the smallest object, would fill it once.
            Check.Equal(collections, GC.CollectionCount(0), "garbage collections");
        }
    }

    public static void PolledClient_RaisesEventsInPollAndLivesOnlyByIt()
    {
        using (var program = new MadeUpProgram())
        {
            var client = new WholehandClient(new ClientOptions { Port = program.Port, Polled = true });
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
            program.HearA(DatagramKind.Heartbeat);
            Thread.Sleep(300); // the game hangs; what was said before is read away
            while (program.Socket.Available > 0) program.Hear();
            Thread.Sleep(200);
            Check.Equal(0, program.Socket.Available, "bytes of heartbeats while nobody polls");
            client.Poll();
            program.HearA(DatagramKind.Heartbeat);
            client.Dispose();
            program.HearA(DatagramKind.Goodbye);
        }
    }

    public static void UnansweredCommand_IsRepeatedThenGivenUp()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            var arm = client.Arm(1);
            var steer = client.Steer(Steering.Person);
            for (int i = 0; i < 5; ++i) program.HearA(DatagramKind.Message);
            Check.True(!arm.IsCompleted, "it waits");
            var stop = client.EmergencyStop();
            Check.Until(() => arm.IsCompleted && steer.IsCompleted, "dropped by the emergency stop");
            Check.True(!arm.Result.Accepted && arm.Result.Reason != "", "in words");
            var b = new FlatBufferBuilder(64);
            int unreadable = Reply.CreateReply(b, 0, false, b.CreateString("is not finite")).Value;
            program.Say(DatagramKind.Reliable, 1, MadeUpProgram.Finished(b, Payload.Reply, unreadable));
            for (int i = 0; i < 5; ++i) program.HearA(DatagramKind.Message);
            Check.True(!stop.IsCompleted, "the emergency stop goes on, whatever else was unreadable");
            b = new FlatBufferBuilder(64);
            int reply = Reply.CreateReply(b, 3, true, b.CreateString("")).Value;
            program.Say(DatagramKind.Reliable, 2, MadeUpProgram.Finished(b, Payload.Reply, reply));
            Check.Until(() => stop.IsCompleted, "answered");
            Check.True(stop.Result.Accepted, "accepted");
            program.HearA(DatagramKind.Message); // the acknowledgement, or a repetition before it
            var again = client.Arm(1);
            Check.Until(() => again.IsCompleted, "given up: the program is there, but never answers");
            Check.True(!again.Result.Accepted && again.Result.Reason.Contains("answer"), again.Result.Reason);
        }
    }

    public static void SilentProgram_IsLostAndFoundAgain()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            program.Alive = false;
            Check.Until(() => !client.Connected, "lost after a second");
            Check.True(!client.Arm(1).Result.Accepted, "commands are refused meanwhile");
            program.Session = 78;
            program.Welcome();
            Check.Until(() => client.Connected, "found again");
            program.States = 0;
            program.SayState(5);
            var state = new HandState();
            Check.Until(() => client.TryGetState(state), "a state of the new conversation");
        }
    }

    public static void HandlerThatThrows_IsToldAndTheClientGoesOn()
    {
        using (var program = new MadeUpProgram())
        using (WholehandClient client = Connected(program))
        {
            string told = "";
            client.HandlerThrew += e => told = e.Message;
            client.StateReceived += s => { throw new InvalidOperationException("of the game"); };
            program.SayState(1);
            Check.Until(() => told == "of the game", "told");
            program.SayState(2);
            Check.Until(() => client.Statistics.Received == 2, "goes on");
            Check.Equal(0L, client.Statistics.Ignored, "the program is not blamed");
        }
    }

    public static void ImpossibleOptions_AreRefused()
    {
        foreach (ClientOptions options in new[]
        {
            new ClientOptions { RateHz = -1 }, new ClientOptions { RateHz = 1001 },
            new ClientOptions { Token = new string('x', 257) }
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
