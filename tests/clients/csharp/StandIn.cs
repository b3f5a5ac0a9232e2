using System;
using System.Diagnostics;
using System.Globalization;

/// <summary>Runs udp_stand_in: the program's own server and UDP bridge with records at 1 kHz. Its values are explained
/// in tests/station/server/udp_fake_backend.hpp.</summary>
public sealed class StandIn : IDisposable
{
    private readonly Process process;

    public StandIn(string port = "0", string token = "")
    {
        process = Process.Start(new ProcessStartInfo(Runner.StandIn, port + " " + token)
        {
            UseShellExecute = false, RedirectStandardInput = true, RedirectStandardOutput = true
        });
        string line = process.StandardOutput.ReadLine();
        Check.True(line != null && line.StartsWith("port "), "the process says its port: " + line);
        Port = int.Parse(line.Substring(5), CultureInfo.InvariantCulture);
    }

    public int Port { get; private set; }

    /// <summary>Ends it and returns the lateness of its own ticks, p99 in ms.</summary>
    public double End()
    {
        process.StandardInput.Close();
        string line = process.StandardOutput.ReadLine();
        Check.True(process.WaitForExit(10000) && process.ExitCode == 0, "ends by itself");
        Console.WriteLine("       program: {0}", line);
        return double.Parse(line.Split(' ')[2], CultureInfo.InvariantCulture);
    }

    public void Kill()
    {
        process.Kill();
        process.WaitForExit();
    }

    public void Dispose()
    {
        if (!process.HasExited) Kill();
    }
}
