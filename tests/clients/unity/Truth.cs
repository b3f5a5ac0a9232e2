using System;
using System.Collections.Generic;
using UnityEngine;
using Wholehand;
using wholehand.protocol;

/// <summary>The program's own poses of links and bodies, received by a separate client over WebSocket and converted to
/// Unity's axes by hand: (-y, z, x).</summary>
internal sealed class Truth : IDisposable
{
    internal struct Place
    {
        public ulong Tick;
        public long SentNs;
        public Frame[] Links, Bodies;
    }

    /// <summary>A position and two directions fixed in an object: the program's x and y, in Unity's axes.</summary>
    internal struct Frame
    {
        public Vector3 At, X, Y;

        public Frame(Pose pose)
        {
            At = ToUnity(pose.PositionM);
            X = Turned(pose.OrientationXyzw, 1, 0, 0);
            Y = Turned(pose.OrientationXyzw, 0, 1, 0);
        }

        /// <summary>The frame of a drawn object, in the axes of <paramref name="frame"/>.</summary>
        public Frame(Transform drawn, Transform frame)
        {
            Quaternion back = Quaternion.Inverse(frame.rotation);
            At = back * (drawn.position - frame.position);
            X = back * drawn.rotation * new Vector3(0, 0, 1);
            Y = back * drawn.rotation * new Vector3(-1, 0, 0);
        }

        // Rows of the textbook's rotation matrix, then (-y, z, x).
        private static Vector3 Turned(QuatXyzw q, float x, float y, float z)
        {
            float vx = (1 - 2 * (q.Y * q.Y + q.Z * q.Z)) * x + 2 * (q.X * q.Y - q.Z * q.W) * y + 2 * (q.X * q.Z + q.Y * q.W) * z;
            float vy = 2 * (q.X * q.Y + q.Z * q.W) * x + (1 - 2 * (q.X * q.X + q.Z * q.Z)) * y + 2 * (q.Y * q.Z - q.X * q.W) * z;
            float vz = 2 * (q.X * q.Z - q.Y * q.W) * x + 2 * (q.Y * q.Z + q.X * q.W) * y + (1 - 2 * (q.X * q.X + q.Y * q.Y)) * z;
            return new Vector3(-vy, vz, vx);
        }
    }

    private readonly WholehandClient client;
    private readonly List<Place> places = new List<Place>();

    public Truth(int port)
    {
        client = new WholehandClient(new ClientOptions { Port = port, RateHz = 0 });
        client.StateReceived += Keep;
        client.Connect();
        Check.Until(() => Count > 0, "states with links");
    }

    public Scene Scene { get { return client.LatestScene.Value; } }

    public WholehandClient Client { get { return client; } }

    public int Count { get { lock (places) return places.Count; } }

    public static Vector3 ToUnity(Vec3 v)
    {
        return new Vector3(-v.Y, v.Z, v.X);
    }

    private void Keep(WorldState s)
    {
        if (s.LinksLength == 0) return;
        var place = new Place { Tick = s.Tick, SentNs = s.SentMonotonicNs, Links = new Frame[s.LinksLength],
            Bodies = new Frame[s.BodiesLength] };
        for (int i = 0; i < place.Links.Length; ++i) place.Links[i] = new Frame(s.Links(i).Value);
        for (int i = 0; i < place.Bodies.Length; ++i) place.Bodies[i] = new Frame(s.Bodies(i).Value);
        lock (places)
        {
            if (places.Count == 0 || place.Tick > places[places.Count - 1].Tick) places.Add(place);
        }
    }

    /// <summary>The two states around a moment, and the moment's share of the time between them; false if they are more
    /// than 25 ms apart or do not exist.</summary>
    public bool Around(Func<Place, long> clock, double ticksPerSecond, long moment, out Place before, out Place after,
        out float share)
    {
        before = after = new Place();
        share = 0;
        lock (places)
        {
            for (int i = 1; i < places.Count; ++i)
            {
                long from = clock(places[i - 1]), to = clock(places[i]);
                if (moment < from || moment > to || (to - from) / ticksPerSecond > 0.025) continue;
                before = places[i - 1];
                after = places[i];
                share = to == from ? 0 : (moment - from) / (float)(to - from);
                return true;
            }
        }
        return false;
    }

    public void Dispose()
    {
        client.Dispose();
    }
}
