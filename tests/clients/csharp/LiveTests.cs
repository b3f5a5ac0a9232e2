using System;
using System.Collections.Generic;
using System.Globalization;
using System.Threading;
using System.Threading.Tasks;
using Wholehand;
using wholehand.protocol;
using static Answers;

/// <summary>The client with a running process: udp_stand_in, which is the program's own server and UDP bridge with
/// records at 1 kHz. Its values are explained in tests/station/server/udp_fake_backend.hpp.</summary>
[Tests]
public static class LiveTests
{
    private const int LeadIn = 0, HolderAlive = 1, Aims = 2, Aimed = 3;

    private static WholehandClient Connect(StandIn program, bool polled = false, string token = "", int rate = 1000)
    {
        var client = new WholehandClient(new ClientOptions
        {
            Port = program.Port, Polled = polled, Token = token, RateHz = rate
        });
        client.Connect();
        return client;
    }

    // Polls, so that polled clients stay alive, until the state meets the condition.
    private static void Shows(WholehandClient client, Func<HandState, bool> condition, string what)
    {
        var state = new HandState();
        Check.Until(() =>
        {
            client.Poll();
            return client.TryGetState(state) && condition(state);
        }, what);
    }

    public static void StatesAtOneKilohertz_ArriveCompleteAndInOrder()
    {
        using (var program = new StandIn())
        using (WholehandClient client = Connect(program))
        {
            var events = new List<float>();
            client.EventsReceived += e =>
            {
                lock (events)
                {
                    for (int i = 0; i < e.Events_Length; ++i) events.Add(e.Events_(i).Value.Value);
                }
            };
            Check.Until(() => client.Statistics.Received > 500, "mono has compiled what is needed");
            States.Judge(client, "UDP at 1 kHz to mono");
            program.End();
            lock (events)
            {
                for (int i = 1; i < events.Count; ++i) Check.Equal(events[i - 1] + 1, events[i], "events in order");
                Check.True(events.Count >= 8, "an event every 250 ms");
            }
        }
    }

    public static void ProgramWithoutDatagrams_IsUsedByWebSocketAlone()
    {
        using (var program = new StandIn("closed:0"))
        using (WholehandClient client = Connect(program))
        {
            Shows(client, s => s.Values[HolderAlive] == 1.0, "states");
            Accepted(client.TakeControls());
            Accepted(client.Steer(Steering.Person));
            client.Aim(new[] { 0.03f, 0, 0, 0, 0, 0, 0, 0, 0 });
            Shows(client, s => s.Values[Aims] == 1 && s.Steering == Steering.Person, "the aim");
            Accepted(client.EmergencyStop());
            Shows(client, s => s.RunState == RunState.Stopped, "stopped");
            Check.Equal(0L, client.Statistics.Received, "datagrams");
        }
    }

    public static void LowRate_IsTheRequestedRate()
    {
        using (var program = new StandIn())
        using (WholehandClient fast = Connect(program))
        using (WholehandClient slow = Connect(program, rate: 60))
        {
            Check.Until(() => slow.Statistics.Received > 20, "states");
            ulong first = 0, last = 0;
            long count = 0;
            slow.StateReceived += s =>
            {
                if (count++ == 0) first = s.Tick;
                last = s.Tick;
            };
            Check.Until(() => Interlocked.Read(ref count) >= 120, "two seconds of states");
            double rate = (count - 1 + slow.Statistics.Lost) * 1000.0 / (last - first);
            Check.Near(60.0, rate, 1.0, "rate by the program's own ticks");
        }
    }

    public static void BodiesAndContacts_ArriveByWebSocketBesideTheDatagrams()
    {
        using (var program = new StandIn())
        using (WholehandClient client = Connect(program))
        {
            var world = new WorldSnapshot();
            Check.True(!client.TryGetWorld(world), "nothing has come");
            Check.Until(() => client.Statistics.Received > 50 && client.LatestScene.HasValue
                && client.TryGetWorld(world), "datagrams, a scene and a state by WebSocket");
            Check.Equal(client.LatestScene.Value.BodiesLength, world.BodyCount, "bodies");
            ulong first = world.Tick;
            Check.Until(() => client.TryGetWorld(world), "the next one");
            Check.True(world.Tick > first, "a later tick");
        }
    }

    public static void RateZero_SendsStatesByWebSocketOnly()
    {
        using (var program = new StandIn())
        using (WholehandClient client = Connect(program, rate: 0))
        {
            int count = 0;
            client.StateReceived += s => ++count;
            Check.Until(() => count > 120, "two seconds of states");
            Check.Equal(0L, client.Statistics.Received, "states by datagram");
        }
    }

    public static void Commands_ChangeTheProgram()
    {
        using (var program = new StandIn())
        using (WholehandClient client = Connect(program))
        {
            Shows(client, s => s.RunState == RunState.Disarmed, "a state");
            Check.Until(() => client.LatestScene.HasValue, "the scene");
            Check.Equal(40, client.LatestScene.Value.CapsulesLength, "capsules");
            Check.Equal("lead_in_m", client.LatestScene.Value.Parameters(0).Value.Name, "parameter");
            Refused(client.Arm(1, 1)); // without the controls
            Accepted(client.TakeControls());
            Check.Until(() => client.HoldsControls, "holds the controls");
            Accepted(client.Arm(1, 1));
            Shows(client, s => s.RunState == RunState.Rendering, "rendering");
            Accepted(client.SetParameter("lead_in_m", 0.0125));
            Shows(client, s => s.Values[LeadIn] == 0.0125, "the parameter");
            Accepted(client.Steer(Steering.Person));
            client.Aim(new[] { 0.03f, 0, 0, 0, 0, 0, 0, 0, 0 });
            Shows(client, s => s.Values[Aims] == 1 && Math.Abs(s.Values[Aimed] - 0.03) < 1e-6
                && s.Steering == Steering.Person, "the aim");
            Accepted(client.Action(Act.Pause));
            Accepted(client.LoadExercise("stand-in", 2));
            Check.Until(() => client.LatestScene.Value.Session == 2, "the new scene");
            Accepted(client.Stop());
            Shows(client, s => s.RunState == RunState.Stopped && s.Endings == 2, "stopped");
            Refused(client.Arm(1, 1)); // pressed before the stop was shown
            Accepted(client.Arm(2, 1));
            Accepted(client.ReleaseControls());
            Check.Until(() => !client.HoldsControls, "released");
        }
    }

    public static void BadCommands_AreRefusedWithTheReasonAndChangeNothing()
    {
        using (var program = new StandIn())
        using (WholehandClient client = Connect(program))
        {
            Check.Until(() => client.Connected, "connected");
            Accepted(client.TakeControls());
            string why = Refused(client.SetParameter("lead_in_m", 0.5));
            Check.True(why.Contains("[0, 0.02]"), why);
            Check.True(Refused(client.SetParameter("no_such", 0.5)).Contains("no_such"), "names the parameter");
            Check.True(Refused(client.SetParameter("lead_in_m", double.NaN)).Contains("finite"), "not finite");
            Check.True(Refused(client.LoadExercise("no-such")).Contains("no-such"), "names the exercise");
            string aim = "";
            client.ReplyReceived += r => { if (!r.Accepted) aim = r.Reason; };
            bool threw = false;
            try { client.Aim(new[] { 0f, float.NaN, 0, 0, 0, 0, 0, 0, 0 }); }
            catch (ArgumentException) { threw = true; }
            Check.True(threw, "an aim that is no number is not sent");
            Check.True(Refused(client.LoadExercise("", 65537)).Contains("65537"), "no other level instead");
            client.Aim(new float[3]);
            Check.Until(() => aim != "", "an aim of too few axes is refused");
            Shows(client, s => s.Values[LeadIn] == 0.005 && s.Values[Aims] == 0, "nothing changed");
            Accepted(client.SetParameter("lead_in_m", 0.01)); // and the next order is obeyed
        }
    }

    public static void SecondGame_MayOnlyWatchAndStop()
    {
        using (var program = new StandIn())
        using (WholehandClient first = Connect(program))
        using (WholehandClient second = Connect(program))
        {
            Check.Until(() => first.Connected && second.Connected, "connected");
            Accepted(first.TakeControls());
            Refused(second.TakeControls());
            Shows(first, s => true, "a state");
            Shows(second, s => true, "a state");
            Refused(second.Arm(1, 1));
            Accepted(first.Arm(1, 1));
            Shows(second, s => s.RunState == RunState.Rendering, "both see it");
            Accepted(second.EmergencyStop());
            Shows(first, s => s.RunState == RunState.Stopped, "stopped");
            first.Dispose();
            Check.Until(() => Ended(second.TakeControls()).Accepted, "free again");
        }
    }

    public static void GameThatHangs_LosesTheControlsUntilItTakesThemAgain()
    {
        using (var program = new StandIn())
        using (WholehandClient watcher = Connect(program))
        using (WholehandClient game = Connect(program, polled: true))
        {
            var taken = Task.FromResult(new CommandReply(false, ""));
            Check.Until(() => game.Connected, "connected");
            taken = game.TakeControls();
            Check.Until(() => { game.Poll(); return taken.IsCompleted; }, "answered");
            Accepted(taken);
            for (int i = 0; i < 30; ++i)
            {
                game.Poll();
                Thread.Sleep(10);
            }
            Shows(watcher, s => s.Values[HolderAlive] == 1.0, "alive");
            // The main thread hangs; the other threads still receive.
            Shows(watcher, s => s.Values[HolderAlive] == 0.0, "silent");
            Check.True(game.Connected, "it is connected all the same");
            Thread.Sleep(1500);  // after a second the controls are lost
            for (int i = 0; i < 30; ++i)
            {
                game.Poll();
                Thread.Sleep(10);
            }
            Shows(watcher, s => s.Values[HolderAlive] == 0.0, "to be alive again is not enough");
            taken = game.TakeControls();
            Check.Until(() => { game.Poll(); return taken.IsCompleted; }, "answered");
            Accepted(taken);
            Shows(watcher, s => s.Values[HolderAlive] == 1.0, "alive again");
        }
    }

    public static void GameThatDies_FadesTheExerciseOutAndFreesTheControls()
    {
        using (var program = new StandIn())
        using (WholehandClient watcher = Connect(program))
        {
            using (WholehandClient game = Connect(program))
            {
                Check.Until(() => game.Connected && watcher.Connected, "connected");
                Accepted(game.TakeControls());
                Shows(watcher, s => s.Values[HolderAlive] == 1.0, "alive");
            }
            Shows(watcher, s => s.Values[HolderAlive] == 0.0, "gone");
            Accepted(watcher.TakeControls());
            Shows(watcher, s => s.Values[HolderAlive] == 1.0, "the next one");
        }
    }

    public static void RestartedProgram_IsFoundAgain()
    {
        using (var program = new StandIn())
        using (WholehandClient client = Connect(program))
        {
            Shows(client, s => true, "states");
            program.Kill(); // without closing the connection
            Check.Until(() => !client.Connected, "lost");
            using (var second = new StandIn(program.Port.ToString(CultureInfo.InvariantCulture)))
            {
                Check.Until(() => client.Connected, "found again");
                Shows(client, s => true, "states again");
                Accepted(client.TakeControls());
            }
        }
    }

    public static void WrongToken_IsRefusedWithAReasonAndTheRightOneAccepted()
    {
        using (var program = new StandIn("0", "a-rather-long-secret"))
        using (WholehandClient wrong = Connect(program, token: "a-wrong-one"))
        using (WholehandClient right = Connect(program, token: "a-rather-long-secret"))
        {
            Check.Until(() => wrong.Refusal.Contains("token"), "refused in words");
            Check.Until(() => right.Connected, "connected");
            Check.True(!wrong.Connected, "not connected");
        }
    }
}
