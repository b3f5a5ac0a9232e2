using System;
using System.Globalization;
using System.Threading;
using Wholehand;

/// <summary>Prints the messages of a running Wholehand: WatchHand.exe [host] [port] [seconds] [token].</summary>
public static class WatchHand
{
    public static int Main(string[] arguments)
    {
        CultureInfo.DefaultThreadCurrentCulture = CultureInfo.InvariantCulture;
        CultureInfo.CurrentCulture = CultureInfo.InvariantCulture;
        var options = new ClientOptions();
        double seconds = double.PositiveInfinity;
        if (arguments.Length > 0) options.Host = arguments[0];
        if (arguments.Length > 1 && !int.TryParse(arguments[1], out options.Port)) return Usage();
        if (arguments.Length > 2 && !double.TryParse(arguments[2], out seconds)) return Usage();
        if (arguments.Length > 3) options.Token = arguments[3];

        using (var client = new WholehandClient(options))
        {
            client.ConnectionChanged += (connected, why) => Console.WriteLine(why);
            client.SceneReceived += scene => Console.WriteLine(
                "scene {0}, exercise {1}, {2} bodies", scene.SceneName, scene.ExerciseName, scene.BodiesLength);
            client.EventsReceived += events =>
            {
                for (int i = 0; i < events.Events_Length; ++i)
                {
                    var e = events.Events_(i).Value;
                    Console.WriteLine("event {0} at tick {1}: {2}", e.Type, e.Tick, e.Value);
                }
            };
            var state = new HandState();
            client.Connect();
            for (double t = 0.0; t < seconds; t += 0.5)
            {
                Thread.Sleep(500);
                if (client.TryGetState(state)) Print(state);
            }
            ClientStatistics s = client.Statistics;
            Console.WriteLine("{0} states, {1} lost, {2} out of order, latency p50 {3:0.00} ms, p99 {4:0.00} ms",
                s.Received, s.Lost, s.OutOfOrder, s.LatencyMs(50), s.LatencyMs(99));
            return s.Received > 0 ? 0 : 1;
        }
    }

    private static void Print(HandState state)
    {
        Console.Write("{0,9:0.000} s {1}:", state.TimeS, state.RunState);
        foreach (float q in state.HandPosition) Console.Write(" {0,7:0.000}", q);
        Console.WriteLine();
    }

    private static int Usage()
    {
        Console.Error.WriteLine("usage: WatchHand.exe [host] [port] [seconds] [token]");
        return 2;
    }
}
