using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Text;
using System.Threading;
using UnityEngine;
using UnityEngine.Headless;
using Wholehand;

/// <summary>Compares the drawn poses of a game with the program's.</summary>
[Tests]
public static class DrawnTests
{
    private const int Cubes = 120;

    private struct Drawn
    {
        public ulong HandTick, WorldTick;
        public long AtNs;
        public Truth.Frame[] Links, Bodies;
    }

    /// <summary>Cubes on a tilted floor, and a ball that rolls down it.</summary>
    private static string ManyBodies()
    {
        var toml = new StringBuilder("kind = \"scene\"\nversion = 1\nname = \"Many\"\ngravity_m_s2 = [0.3, 0.1, -9.81]\n"
            + "[[bodies]]\nname = \"floor\"\nshape = \"box\"\nsize_m = [9.0, 9.0, 0.04]\nfixed = true\n"
            + "position_m = [2.0, 0.0, -0.4]\n[[bodies]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.05\n"
            + "mass_kg = 0.1\nposition_m = [0.8, 0.0, -0.33]\n");
        for (int i = 0; i < Cubes; ++i)
        {
            toml.AppendFormat(CultureInfo.InvariantCulture, "[[bodies]]\nname = \"cube {0}\"\nshape = \"box\"\n"
                + "size_m = [0.04, 0.05, 0.06]\nmass_kg = 0.1\nposition_m = [{1:0.000}, {2:0.000}, -0.34]\n",
                i, -0.6 + 0.1 * (i % 12), -0.5 + 0.1 * (i / 12));
        }
        string file = Path.GetFullPath("many.toml");
        File.WriteAllText(file, toml.ToString());
        return file;
    }

    private static Truth.Frame[] FramesOf(int count, Func<int, Transform> at, Transform frame)
    {
        var frames = new Truth.Frame[count];
        for (int i = 0; i < count; ++i) frames[i] = new Truth.Frame(at(i), frame);
        return frames;
    }

    /// <summary>Draws for some seconds at 60 Hz and returns the frames.</summary>
    private static List<Drawn> Draw(Game game, double seconds, bool predictsEveryOther = false)
    {
        var frames = new List<Drawn>();
        DateTime end = DateTime.UtcNow.AddSeconds(seconds);
        while (DateTime.UtcNow < end)
        {
            game.Hand.PredictMotion = predictsEveryOther && frames.Count % 2 == 1;
            game.Frame(0);
            frames.Add(new Drawn
            {
                HandTick = game.Hand.DrawnTick, WorldTick = game.World.DrawnTick, AtNs = MonotonicClock.NowNs(),
                Links = FramesOf(game.Hand.LinkCount, game.Hand.Link, game.Hand.transform),
                Bodies = FramesOf(game.World.BodyCount, i => game.World.Body(i).transform, game.World.transform)
            });
            Thread.Sleep(15);
        }
        Thread.Sleep(100); // waits for the true states of the last frames
        Game.NoErrors();
        return frames;
    }

    private static double Furthest(Truth.Frame[] drawn, Truth.Frame[] before, Truth.Frame[] after, float share)
    {
        double worst = 0;
        for (int i = 0; i < drawn.Length; ++i)
        {
            Vector3 at = before[i].At + share * (after[i].At - before[i].At);
            worst = Math.Max(worst, (drawn[i].At - at).magnitude);
        }
        return worst;
    }

    // Angles between two states are not known: only a frame of exactly the same tick is compared.
    private static double MostTurned(Truth.Frame[] drawn, Truth.Frame[] truth)
    {
        double worst = 0;
        for (int i = 0; i < drawn.Length; ++i)
        {
            worst = Math.Max(worst, Math.Max((drawn[i].X - truth[i].X).magnitude, (drawn[i].Y - truth[i].Y).magnitude));
        }
        return worst;
    }

    private sealed class Comparison
    {
        private readonly List<double> off = new List<double>();
        private double turned;
        private int ofTheTick;

        public void Add(Truth truth, ulong tick, Truth.Frame[] drawn, Func<Truth.Place, Truth.Frame[]> of)
        {
            Truth.Place before, after;
            if (!truth.Around(p => (long)p.Tick, 1000, (long)tick, out before, out after, out float share)) return;
            off.Add(Furthest(drawn, of(before), of(after), share));
            if (before.Tick != tick && after.Tick != tick) return;
            ++ofTheTick;
            turned = Math.Max(turned, MostTurned(drawn, of(before.Tick == tick ? before : after)));
        }

        /// <summary>Checks for 2 mm, the figure of the program; angles may differ by single precision only.</summary>
        public string Judge(string what)
        {
            Check.True(off.Count > 30 && ofTheTick > 2, what + ": compared " + off.Count + " frames, " + ofTheTick + " of the tick");
            off.Sort();
            double worst = off[off.Count - 1];
            Check.True(worst <= 0.002, what + " are drawn off by " + worst + " m");
            Check.True(turned < 1e-4, what + " are turned by " + turned + " rad");
            return string.Format("{0} in {1} frames p99 {2:0.000} mm, worst {3:0.000} mm, {4:0.0E+0} rad", what, off.Count,
                1e3 * off[off.Count * 99 / 100], 1e3 * worst, turned);
        }
    }

    private static double Moved(List<Drawn> frames, Func<Drawn, Truth.Frame> what)
    {
        double most = 0;
        foreach (Drawn drawn in frames) most = Math.Max(most, (what(drawn).At - what(frames[0]).At).magnitude);
        return most;
    }

    public static void Hand_MatchesTheProgramsPoses()
    {
        using (var program = new RealProgram())
        using (var truth = new Truth(program.Port))
        using (var game = new Game(program.Port))
        {
            game.FramesUntilDrawn();
            List<Drawn> frames = Draw(game, 3);
            Check.True(game.Connection.Client.Statistics.Received > 1000, "states come by datagram");
            var links = new Comparison();
            foreach (Drawn drawn in frames) links.Add(truth, drawn.HandTick, drawn.Links, p => p.Links);
            List<double> now = OffNow(truth, frames);
            double moved = Moved(frames, d => d.Links[3]);
            Check.True(moved > 0.01, "the hand moves");
            Console.WriteLine("figure: Unity package under mono, the bar: {0}; against the program's at the time of the frame p99 "
                + "{1:0.00} mm; the hand moved {2:0} mm", links.Judge("links"), 1e3 * now[now.Count * 99 / 100], 1e3 * moved);
        }
    }

    // For each frame, the largest distance of a link from its true position at the time of the frame.
    private static List<double> OffNow(Truth truth, IEnumerable<Drawn> frames)
    {
        var off = new List<double>();
        foreach (Drawn drawn in frames)
        {
            Truth.Place before, after;
            if (truth.Around(p => p.SentNs, 1e9, drawn.AtNs, out before, out after, out float share))
            {
                off.Add(Furthest(drawn.Links, before.Links, after.Links, share));
            }
        }
        off.Sort();
        return off;
    }

    public static void PredictedHand_MatchesThePresentPose()
    {
        using (var program = new RealProgram())
        using (var truth = new Truth(program.Port))
        using (var game = new Game(program.Port))
        {
            game.Connection.RateHz = 0; // 60 states a second by WebSocket
            game.FramesUntilDrawn();
            List<Drawn> frames = Draw(game, 5, true); // with and without prediction see the same motion
            List<double> asTheyCome = OffNow(truth, frames.Where((f, i) => i % 2 == 0)),
                predicted = OffNow(truth, frames.Where((f, i) => i % 2 == 1));
            Check.True(Moved(frames, d => d.Links[3]) > 0.01, "the hand moves");
            Check.True(asTheyCome.Count > 50 && predicted.Count > 50, "frames");
            Console.WriteLine("figure: Unity package under mono, the bar by WebSocket: links at the time of the frame p99 {0:0.00} mm, "
                + "mean {1:0.00} mm; predicted p99 {2:0.00} mm, mean {3:0.00} mm", 1e3 * asTheyCome[asTheyCome.Count * 99 / 100],
                1e3 * asTheyCome.Average(), 1e3 * predicted[predicted.Count * 99 / 100], 1e3 * predicted.Average());
            Check.True(predicted.Average() < 0.6 * asTheyCome.Average(), "prediction draws the hand where it is");
            game.Hand.PredictMotion = true;
            Check.Equal(0L, Game.AllocatedIn(300, () => { }), "bytes that predicted frames allocate");
        }
    }

    public static void ManyBodies_MatchTheProgramsPosesAndAllocateNothing()
    {
        using (var program = new RealProgram("--udp 0 --port 0 --scene " + ManyBodies()))
        using (var truth = new Truth(program.Port))
        using (var game = new Game(program.Port, true))
        {
            game.FramesUntilDrawn();
            Check.Equal(Cubes + 2, game.World.BodyCount, "bodies");
            List<Drawn> frames = Draw(game, 1.5); // afterwards all code is compiled
            var bodies = new Comparison();
            foreach (Drawn drawn in frames) bodies.Add(truth, drawn.WorldTick, drawn.Bodies, p => p.Bodies);
            double moved = Moved(frames, d => d.Bodies[1]);
            Check.True(moved > 0.05, "the ball rolls, " + moved + " m");
            Console.WriteLine("figure: Unity package under mono, {0} bodies: {1}; the ball rolled {2:0} mm", Cubes + 2,
                bodies.Judge("bodies"), 1e3 * moved);
            ExpectNoAllocation(game);
        }
    }

    private static void ExpectNoAllocation(Game game)
    {
        const int Frames = 500;
        int statesTaken = 0, worldsTaken = 0;
        ulong handTick = 0, worldTick = 0;
        long sum = Game.AllocatedIn(Frames, () =>
        {
            if (game.Hand.DrawnTick != handTick) ++statesTaken;
            if (game.World.DrawnTick != worldTick) ++worldsTaken;
            handTick = game.Hand.DrawnTick;
            worldTick = game.World.DrawnTick;
        });
        Console.WriteLine("figure: Unity package under mono, {0} frames with {1} bodies, {2} new states of the hand, {3} of the "
            + "bodies: {4} bytes allocated", Frames, Cubes + 2, statesTaken, worldsTaken, sum);
        Check.True(statesTaken > Frames / 2 && worldsTaken > 20, "new states are drawn");
        Check.Equal(0L, sum, "bytes allocated");
        Game.NoErrors();
    }
}
