using System;
using System.Threading;
using UnityEngine;
using UnityEngine.Headless;
using Wholehand.Unity;

/// <summary>A game with a connection, a hand and a world, translated and rotated in the game's own world; it is run
/// frame by frame.</summary>
internal sealed class Game : IDisposable
{
    public const float FixedPeriodS = 0.02f;

    public readonly GameObject Root;
    public readonly WholehandConnection Connection;
    public readonly WholehandHand Hand;
    public readonly WholehandWorld World;

    public Game(int port, bool physics = false)
    {
        Root = new GameObject("Wholehand");
        Root.transform.localPosition = new Vector3(1.0f, 2.0f, -3.0f);
        Root.transform.localRotation = Quaternion.AngleAxis(40.0f, new Vector3(1, 2, 3));
        Connection = Root.AddComponent<WholehandConnection>();
        Connection.Port = port;
        Hand = Below("Hand").AddComponent<WholehandHand>();
        Hand.KinematicCapsules = physics;
        Hand.gameObject.AddComponent<WholehandGizmos>();
        World = Below("World").AddComponent<WholehandWorld>();
        World.KinematicColliders = physics;
    }

    private GameObject Below(string name)
    {
        var below = new GameObject(name);
        below.transform.SetParent(Root.transform, false);
        return below;
    }

    public void Frame(int sleepMs = 2)
    {
        Player.Frame(1, FixedPeriodS);
        if (sleepMs > 0) Thread.Sleep(sleepMs);
    }

    public void FramesUntil(Func<bool> condition, string what)
    {
        Check.Until(() =>
        {
            Frame(0);
            return condition();
        }, what);
    }

    public void FramesUntilDrawn()
    {
        FramesUntil(() => Hand.DrawnSession != 0 && World.BodyCount > 0 && World.DrawnTick != ulong.MaxValue, "the hand and the bodies are drawn");
        NoErrors();
    }

    /// <summary>Bytes that so many frames allocate; `each` is called after each frame and not counted.</summary>
    public static long AllocatedIn(int frames, Action each)
    {
        long sum = 0;
        for (int i = 0; i < frames; ++i)
        {
            long before = GC.GetAllocatedBytesForCurrentThread();
            Player.Frame(1, FixedPeriodS);
            sum += GC.GetAllocatedBytesForCurrentThread() - before;
            each();
            Thread.Sleep(2);
        }
        return sum;
    }

    public static void NoErrors()
    {
        Check.Equal("", string.Join("\n", Debug.Errors), "errors in the console");
    }

    public void Dispose()
    {
        Player.Quit();
    }
}
