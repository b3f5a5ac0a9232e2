using System;
using System.Collections.Generic;
using System.Linq;
using Wholehand;
using wholehand.protocol;

/// <summary>Converts what a game sends and receives for its bodies from and to the canonical form.</summary>
internal static class Bodies
{
    /// <summary>The argument of an order, as an array of the client's own type.</summary>
    public static Array Given(Type element, List<object> entry)
    {
        Array given = Array.CreateInstance(element, entry.Count);
        for (int i = 0; i < entry.Count; ++i) given.SetValue(Of(element, (Dictionary<string, object>)entry[i]), i);
        return given;
    }

    private static object Of(Type type, Dictionary<string, object> f)
    {
        if (type == typeof(BodyId)) return Id(f);
        if (type == typeof(BodyAt)) return new BodyAt(Id(f), Position(f, "pose"), Orientation(f, "pose"));
        if (type == typeof(BodyOwnerChange)) return new BodyOwnerChange(Id(f), (BodyOwner)Whole(f, "owner"));
        if (type == typeof(BodyToSpawn))
        {
            return new BodyToSpawn
            {
                Slot = Whole(f, "slot"), Generation = Whole(f, "generation"), ShapeSet = Whole(f, "shape_set"),
                Owner = (BodyOwner)Whole(f, "owner"), MassKg = Number(f, "mass_kg"),
                Friction = f.ContainsKey("friction") ? Number(f, "friction") : new BodyToSpawn().Friction,
                PositionM = Position(f, "pose"), Orientation = Orientation(f, "pose"), VelocityMS = Triple(Inner(f, "velocity_m_s")),
                RefuseOverlap = f.ContainsKey("refuse_overlap") && (bool)f["refuse_overlap"]
            };
        }
        if (type != typeof(BodyShape)) throw new NotSupportedException("no form of " + type);
        return new BodyShape
        {
            Type = (ShapeType)Whole(f, "type"), HalfExtentsM = Triple(Inner(f, "half_extents_m")), RadiusM = Number(f, "radius_m"),
            LengthM = Number(f, "length_m"),
            PointsM = All(f, "points_m").Select(p => Triple((Dictionary<string, object>)p)).ToArray(),
            Triangles = All(f, "triangles").Select(Convert.ToUInt32).ToArray(),
            PositionM = Position(f, "in_body"), Orientation = Orientation(f, "in_body")
        };
    }

    private static BodyId Id(Dictionary<string, object> f)
    {
        return new BodyId(Whole(f, "slot"), Whole(f, "generation"));
    }

    private static List<object> All(Dictionary<string, object> f, string name)
    {
        return f.ContainsKey(name) ? (List<object>)f[name] : new List<object>();
    }

    private static Dictionary<string, object> Inner(Dictionary<string, object> f, string name)
    {
        return (Dictionary<string, object>)f[name];
    }

    private static uint Whole(Dictionary<string, object> f, string name)
    {
        return f.ContainsKey(name) ? Convert.ToUInt32(f[name]) : 0;
    }

    private static float Number(Dictionary<string, object> f, string name)
    {
        return f.ContainsKey(name) ? Golden.Single(f[name]) : 0;
    }

    private static Vector Triple(Dictionary<string, object> f)
    {
        return new Vector(Number(f, "x"), Number(f, "y"), Number(f, "z"));
    }

    private static Vector Position(Dictionary<string, object> f, string pose)
    {
        return Triple(Inner(Inner(f, pose), "position_m"));
    }

    private static Rotation Orientation(Dictionary<string, object> f, string pose)
    {
        Dictionary<string, object> q = Inner(Inner(f, pose), "orientation_xyzw");
        return new Rotation(Number(q, "x"), Number(q, "y"), Number(q, "z"), Number(q, "w"));
    }

    /// <summary>Replaces the message's bodies by those of the game's copy.</summary>
    public static void Copied(WholehandClient client, Dictionary<string, object> read)
    {
        var slots = new BodySlots();
        if (!client.TryGetBodies(slots)) throw new Exception("no copy of the bodies"); // not an expected error of damaged bytes: it escapes
        CopyRegistered(slots, read);
        if (slots.Count == 0 && !read.ContainsKey("bodies")) return;
        read["bodies"] = Enumerable.Range(0, slots.Count).Select(i => (object)new Dictionary<string, object>
        {
            { "slot", (long)slots.Bodies[i].Slot }, { "generation", (long)slots.Bodies[i].Generation },
            { "shapes", (long)slots.Shapes[i] }, { "state", (long)slots.States[i] }
        }).ToList();
    }

    // The copy has no entry for a number that no body has any more, or never had. If a damaged list has a number twice,
    // the copy has its last body.
    private static void CopyRegistered(BodySlots slots, Dictionary<string, object> read)
    {
        if (!read.ContainsKey("registered")) return;
        var all = (List<object>)read["registered"];
        for (int i = 0; i < all.Count; ++i)
        {
            var entry = (Dictionary<string, object>)all[i];
            var name = new BodyId(Whole(entry, "number"), Whole(entry, "generation"));
            int found = slots.FindInAll(name);
            if (found >= 0 && name.IsNumber) all[i] = Registered(slots.All[found]);
            else if (all.Skip(i + 1).Any(later => Whole((Dictionary<string, object>)later, "number") == name.Slot)) continue;
            else if (name.IsNumber && Whole(entry, "whereabouts") != (uint)Whereabouts.Gone) throw new Exception("no body " + name.Slot);
        }
    }

    private static object Registered(BodyInWorld body)
    {
        return new Dictionary<string, object>
        {
            { "number", (long)body.Id.Slot }, { "generation", (long)body.Id.Generation }, { "shapes", (long)body.Shapes },
            { "slot", (long)body.LoopSlot }, { "whereabouts", (long)body.Whereabouts },
            {
                "pose", new Dictionary<string, object>
                {
                    { "position_m", Golden.Vector(body.PositionM) }, { "orientation_xyzw", Golden.Rotation(body.Orientation) }
                }
            }
        };
    }
}
