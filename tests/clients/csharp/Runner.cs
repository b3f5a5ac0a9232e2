using System;
using System.Collections.Generic;
using System.Globalization;
using System.Reflection;

/// <summary>Marks a class of tests: every public static method without parameters is a test.</summary>
[AttributeUsage(AttributeTargets.Class)]
public sealed class TestsAttribute : Attribute
{
}

public sealed class Failure : Exception
{
    public Failure(string what) : base(what)
    {
    }
}

public static class Check
{
    public static void True(bool condition, string what)
    {
        if (!condition) throw new Failure(what);
    }

    public static void Equal<T>(T expected, T actual, string what)
    {
        if (!EqualityComparer<T>.Default.Equals(expected, actual))
        {
            throw new Failure(what + ": expected " + expected + ", is " + actual);
        }
    }

    public static void Near(double expected, double actual, double tolerance, string what)
    {
        if (!(Math.Abs(expected - actual) <= tolerance))
        {
            throw new Failure(what + ": expected " + expected + " ± " + tolerance + ", is " + actual);
        }
    }

    /// <summary>Waits up to 300 s for a condition, so that no test depends on the speed of the machine.</summary>
    public static void Until(Func<bool> condition, string what)
    {
        DateTime end = DateTime.UtcNow.AddSeconds(300);
        while (!condition())
        {
            if (DateTime.UtcNow > end) throw new Failure("not within 300 s: " + what);
            System.Threading.Thread.Sleep(2);
        }
    }
}

public static class Latency
{
    /// <summary>Checks for 5 ms at p99, the figure of the program. It is not checked on a machine that wakes a thread
    /// more than 2 ms late at p99.</summary>
    public static void Judge(double p99Ms, double machineP99Ms)
    {
        if (p99Ms <= 5.0) return;
        Check.True(machineP99Ms > 2.0, "latency p99 is " + p99Ms + " ms");
        Console.WriteLine("not judged: clients_csharp.Latency: this machine kept a sleeper waiting for {1} ms (p99 {0} ms)", p99Ms, machineP99Ms);
    }
}

/// <summary>WholehandTests.exe [udp_stand_in [wholehand]]: runs all tests; those with running processes only if these
/// are named. The exit code is the number of failures.</summary>
public static class Runner
{
    public static string StandIn, Program;
    public static string Filter = Environment.GetEnvironmentVariable("WHOLEHAND_ONLY"); // part of a test's name
    public static bool Full = Environment.GetEnvironmentVariable("WHOLEHAND_FULL") == "1";

    public static int Seed
    {
        get
        {
            return long.TryParse(Environment.GetEnvironmentVariable("WHOLEHAND_SEED"), out long seed) ? (int)(seed % 1000000) : 1;
        }
    }

    public static int Main(string[] arguments)
    {
        CultureInfo.CurrentCulture = CultureInfo.InvariantCulture;
        if (arguments.Length > 0) StandIn = arguments[0];
        if (arguments.Length > 1) Program = arguments[1];
        int failed = 0, passed = 0;
        foreach (Type type in Assembly.GetExecutingAssembly().GetTypes())
        {
            if (type.GetCustomAttributes(typeof(TestsAttribute), false).Length == 0) continue;
            if (type.Name == "LiveTests" && StandIn == null) continue;
            if (type.Name.StartsWith("Real") && Program == null) continue;
            foreach (MethodInfo method in type.GetMethods(
                BindingFlags.Public | BindingFlags.Static | BindingFlags.DeclaredOnly))
            {
                if (method.GetParameters().Length != 0) continue;
                if (Filter != null && !(type.Name + "." + method.Name).Contains(Filter)) continue;
                if (Run(type, method)) ++passed;
                else ++failed;
            }
        }
        Console.WriteLine("{0} passed, {1} failed", passed, failed);
        // A run without any test is a failure.
        return passed == 0 ? 1 : failed;
    }

    private static bool Run(Type type, MethodInfo method)
    {
        string name = type.Name + "." + method.Name;
        var clock = System.Diagnostics.Stopwatch.StartNew();
        try
        {
            method.Invoke(null, null);
            Console.WriteLine("ok     {0}, {1:0.0} s", name, clock.Elapsed.TotalSeconds);
            return true;
        }
        catch (TargetInvocationException e)
        {
            var failure = e.InnerException as Failure;
            Console.WriteLine("FAILED {0}: {1}", name, failure != null ? failure.Message : e.InnerException.ToString());
            return false;
        }
    }
}
