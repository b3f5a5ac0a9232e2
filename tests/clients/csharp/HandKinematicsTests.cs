using System;
using System.Collections.Generic;
using Wholehand;
using wholehand.protocol;

/// <summary>Link poses from a scene and joint positions, compared with the program's own poses over WebSocket, and with
/// a crank computed by hand.</summary>
[Tests]
public static class HandKinematicsTests
{
    /// <summary>A crank: translated along x, then rotated about z at y = 0.1 m.</summary>
    private static Scene Crank()
    {
        var b = new FlatBuffers.FlatBufferBuilder(1024);
        var links = new List<FlatBuffers.Offset<Link>>();
        foreach (bool arm in new[] { false, true })
        {
            var name = b.CreateString(arm ? "arm" : "carriage");
            Link.StartLink(b);
            Link.AddName(b, name);
            Link.AddParent(b, (short)(arm ? 0 : -1));
            Link.AddJoint(b, (short)(arm ? 1 : 0));
            Link.AddType(b, arm ? JointType.Revolute : JointType.Prismatic);
            Link.AddAxis(b, Vec3.CreateVec3(b, arm ? 0 : 1, 0, arm ? 1 : 0));
            Link.AddAtZero(b, Pose.CreatePose(b, 0, arm ? 0.1f : 0, 0, 0, 0, 0, 1));
            links.Add(Link.EndLink(b));
        }
        var all = Scene.CreateLinksVector(b, links.ToArray());
        Scene.StartScene(b);
        Scene.AddLinks(b, all);
        b.Finish(Scene.EndScene(b).Value);
        return Scene.GetRootAsScene(b.DataBuffer);
    }

    public static void Crank_MatchesTheHandCalculation()
    {
        var hand = new HandKinematics(Crank());
        hand.Update(new[] { 0.3f, (float)(Math.PI / 2) });
        int arm = hand.Find("arm");
        Check.Near(0.3, hand.Position(arm).X, 1e-6, "x");
        Check.Near(0.1, hand.Position(arm).Y, 1e-6, "y");
        Check.Near(Math.Sqrt(0.5), hand.Orientation(arm).Z, 1e-6, "half a right angle about z");
        Check.Equal(-1, hand.Find("leg"), "no such link");
    }

    public static void Updates_AllocateNothing()
    {
        var hand = new HandKinematics(Crank());
        var joints = new float[2];
        long allocated = 0;
        for (int i = 0; i < 10000; ++i)
        {
            if (i == 1000) allocated = GC.GetAllocatedBytesForCurrentThread();
            joints[1] = 1e-4f * i;
            hand.Update(joints);
        }
        Check.Equal(0L, GC.GetAllocatedBytesForCurrentThread() - allocated, "bytes allocated");
    }

    public static void SceneWithoutLinks_IsRefusedWithTheReason()
    {
        var b = new FlatBuffers.FlatBufferBuilder(64);
        Scene.StartScene(b);
        b.Finish(Scene.EndScene(b).Value);
        Scene scene = Scene.GetRootAsScene(b.DataBuffer);
        try
        {
            new HandKinematics(scene);
        }
        catch (ArgumentException refused)
        {
            Check.True(refused.Message.Contains("older than this client"), refused.Message);
            return;
        }
        throw new Failure("a hand without links");
    }

    // Tolerance: single precision through a chain of links, some 1e-6 m and rad.
    public static void ShippedHand_MatchesTheProgramsLinkPoses()
    {
        if (Runner.Program == null) return;
        using (var program = new RealProgram("--port 0")) // without datagrams, states are complete and have the links
        using (var client = new WholehandClient(new ClientOptions { Port = program.Port }))
        {
            HandKinematics hand = null;
            int compared = 0, links = 0;
            double worst = 0;
            client.SceneReceived += scene => hand = new HandKinematics(scene);
            client.StateReceived += state =>
            {
                if (hand == null || state.LinksLength == 0) return;
                var joints = new float[state.ThetaLength];
                for (int i = 0; i < joints.Length; ++i) joints[i] = state.Theta(i);
                hand.Update(joints);
                links = state.LinksLength;
                for (int i = 0; i < links; ++i) worst = Math.Max(worst, Difference(state.Links(i).Value, hand, i));
                ++compared;
            };
            client.Connect();
            Check.Until(() => compared > 60, "states with links");
            Check.Equal(hand.LinkCount, links, "links");
            Check.True(worst < 5e-6, "the largest difference is " + worst);
        }
    }

    private static double Difference(Pose said, HandKinematics hand, int link)
    {
        Vector p = hand.Position(link);
        Rotation q = hand.Orientation(link);
        Vec3 at = said.PositionM;
        QuatXyzw turn = said.OrientationXyzw;
        double sign = turn.X * q.X + turn.Y * q.Y + turn.Z * q.Z + turn.W * q.W < 0 ? -1 : 1; // q and -q are the same rotation
        double[] differences =
        {
            at.X - p.X, at.Y - p.Y, at.Z - p.Z, turn.X - sign * q.X, turn.Y - sign * q.Y, turn.Z - sign * q.Z, turn.W - sign * q.W
        };
        double worst = 0;
        foreach (double d in differences) worst = Math.Max(worst, Math.Abs(d));
        return worst;
    }
}
