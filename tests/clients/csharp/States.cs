using System;
using System.Collections.Generic;
using System.Threading;
using Wholehand;

/// <summary>Checks that the states of some seconds arrive complete, in order and in time.</summary>
internal static class States
{
    /// <summary>How late this machine wakes an idle thread, p99 in ms; a busy machine adds this to every
    /// latency.</summary>
    private sealed class Jitter
    {
        private readonly List<double> late = new List<double>();
        private readonly Thread thread;
        private volatile bool stop;

        public Jitter()
        {
            thread = new Thread(() =>
            {
                while (!stop)
                {
                    long before = MonotonicClock.NowNs();
                    Thread.Sleep(1);
                    late.Add((MonotonicClock.NowNs() - before) * 1e-6 - 1.0);
                }
            });
            thread.Start();
        }

        public double P99()
        {
            stop = true;
            thread.Join();
            late.Sort();
            return late[late.Count * 99 / 100];
        }
    }

    public static void Judge(WholehandClient client, string what)
    {
        int seconds = Runner.Full ? 60 : 2;
        ulong last = 0;
        long backwards = 0, skipped = 0;
        client.StateReceived += s =>
        {
            if (s.Tick < last) ++backwards; // the same state may come twice if no new one comes
            if (last != 0 && s.Tick > last + 1) skipped += (long)(s.Tick - last - 1);
            last = s.Tick;
        };
        client.Statistics.Reset();
        var jitter = new Jitter();
        Thread.Sleep(1000 * seconds);
        ClientStatistics s1 = client.Statistics;
        long received = s1.Received, lost = s1.Lost, disorder = s1.OutOfOrder;
        double p50 = s1.LatencyMs(50), p99 = s1.LatencyMs(99), share = s1.Share, late = jitter.P99();
        Console.WriteLine("figure: {8}, {0} s: {1} received, {2} lost ({3:0.00000} %), {4} out of order; {5} ticks skipped by the "
            + "program; latency p50 {6:0.00} ms, p99 {7:0.00} ms; an idle thread is {9:0.00} ms late, p99",
            seconds, received, lost, 100.0 * (1.0 - share), disorder, skipped, p50, p99, what, late);
        Check.True(share >= 0.999, "less than 99.9 % received");
        Check.Equal(0L, disorder + backwards, "out of order");
        // A second at 1 kHz has a thousand states on any machine: late ones come in a batch.
        Check.True(received + skipped > 0.9 * 1000 * seconds, "less than 900 ticks a second");
        Latency.Judge(p99, late);
    }
}
