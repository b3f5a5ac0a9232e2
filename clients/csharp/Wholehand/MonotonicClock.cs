using System.Diagnostics;

namespace Wholehand
{
    /// <summary>Time since an arbitrary start; it never decreases. On Linux it is the program's clock
    /// (CLOCK_MONOTONIC), so that latencies can be measured on one machine.</summary>
    public static class MonotonicClock
    {
        public static long NowNs()
        {
            long ticks = Stopwatch.GetTimestamp();
            long seconds = ticks / Stopwatch.Frequency;
            long rest = ticks % Stopwatch.Frequency;
            return seconds * 1000000000L + rest * 1000000000L / Stopwatch.Frequency;
        }
    }
}
