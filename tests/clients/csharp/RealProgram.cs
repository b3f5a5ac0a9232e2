using System;
using System.Diagnostics;
using System.Globalization;
using System.Text.RegularExpressions;
using System.Threading;

/// <summary>Runs `wholehand run` with its virtual patient and without a rehearsal; it ends with this process, whatever
/// happens to the test.</summary>
public sealed class RealProgram : IDisposable
{
    private readonly Process process;

    public RealProgram(string arguments = "--udp 0 --port 0")
    {
        process = Process.Start(new ProcessStartInfo("setpriv",
            "--pdeathsig KILL \"" + Runner.Program + "\" run --no-rehearsal " + arguments)
        {
            UseShellExecute = false, RedirectStandardOutput = true, RedirectStandardInput = true
        });
        new Thread(ReadAll) { IsBackground = true }.Start();
        try
        {
            Check.Until(() => Port != 0, "the program opens its port");
        }
        catch (Failure)
        {
            Dispose();
            throw;
        }
    }

    // Reads to the end, so that the output does not fill the pipe.
    private void ReadAll()
    {
        string line;
        while ((line = process.StandardOutput.ReadLine()) != null)
        {
            Match port = Regex.Match(line, @"^http://[^/]*:(\d+)/$");
            if (port.Success) Port = int.Parse(port.Groups[1].Value, CultureInfo.InvariantCulture);
        }
    }

    public int Port { get; private set; }

    public void Dispose()
    {
        if (!process.HasExited) process.Kill();
        process.WaitForExit();
    }
}
