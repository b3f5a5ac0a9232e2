using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Reflection;
using FlatBuffers;
using Wholehand;
using wholehand.protocol;

/// <summary>The C# client reads and writes golden messages and datagrams: Golden.exe JOB.json ANSWER.json. Bytes enter
/// where a socket's bytes do, and orders leave by the methods that a game calls.</summary>
public static class Golden
{
    private const BindingFlags Inside = BindingFlags.NonPublic | BindingFlags.Instance | BindingFlags.Static;
    private static Form form;

    public static int Main(string[] arguments)
    {
        var job = (Dictionary<string, object>)Json.Read(File.ReadAllText(arguments[0]));
        form = new Form((Dictionary<string, object>)job["layout"]);
        var answer = new Dictionary<string, object>
        {
            { "read", Each(job, "read", entry => TimedRead(BytesOf(entry["bytes"]))) },
            { "write", Each(job, "write", Write) },
            { "datagrams", Each(job, "datagrams", Datagrams.Judge) },
            { "longest_s", longestS }
        };
        File.WriteAllText(arguments[1], Json.Write(answer));
        return 0;
    }

    private static object Each(Dictionary<string, object> job, string what, Func<Dictionary<string, object>, object> answer)
    {
        return ((List<object>)job[what]).Cast<Dictionary<string, object>>().ToDictionary(entry => (string)entry["name"], answer);
    }

    public static byte[] BytesOf(object base64)
    {
        return Convert.FromBase64String((string)base64);
    }

    public static object Of(string name, object value)
    {
        return new Dictionary<string, object> { { name, value } };
    }

    public static T Get<T>(WholehandClient client, string field)
    {
        return (T)typeof(WholehandClient).GetField(field, Inside).GetValue(client);
    }

    public static void Set(WholehandClient client, string field, object value)
    {
        typeof(WholehandClient).GetField(field, Inside).SetValue(client, value);
    }

    private static bool IsOfRubbish(Exception e)
    {
        return (bool)typeof(WholehandClient).GetMethod("IsOfRubbish", Inside).Invoke(null, new object[] { e });
    }

    // ---- messages of the program ----

    private static double longestS;

    private static object TimedRead(byte[] bytes)
    {
        TimeSpan began = UsedTime();
        try
        {
            return Read(bytes);
        }
        catch (Exception e)
        {
            return Of("escaped", e.ToString()); // the runner counts escaped exceptions
        }
        finally
        {
            longestS = Math.Max(longestS, (UsedTime() - began).TotalSeconds);
        }
    }

    // Processor time, so that pauses of the machine do not count.
    private static TimeSpan UsedTime()
    {
        using (Process here = Process.GetCurrentProcess()) return here.TotalProcessorTime;
    }

    private static object Read(byte[] bytes)
    {
        using (var client = new WholehandClient(new ClientOptions { RateHz = 0 }))
        {
            string kind = null;
            object table = null;
            client.StateReceived += state => { kind = "WorldState"; table = state; };
            client.SceneReceived += scene => { kind = "Scene"; table = scene; };
            client.EventsReceived += events => { kind = "Events"; table = events; };
            client.ReplyReceived += reply => { kind = "Reply"; table = reply; };
            client.ControlsChanged += controls => { kind = "Controls"; table = controls; };
            client.BodiesChanged += bodies => { kind = "GameBodies"; table = bodies; };
            try
            {
                Payload unheard = Unheard(bytes);
                if (unheard == Payload.Welcome) return Payloads("Welcome", form.Table("Welcome", WelcomeOf(bytes)));
                if (unheard != Payload.NONE) return Of("unread", true);
                Hear(client, bytes);
                if (kind == null) return Of("refused", "");
                Dictionary<string, object> read = form.Table(kind, table);
                if (kind == "WorldState") Copied(client, read);
                if (kind == "GameBodies") Bodies.Copied(client, read);
                return Payloads(kind, read);
            }
            catch (Exception e) when (IsOfRubbish(e) || (e is TargetInvocationException && IsOfRubbish(e.InnerException)))
            {
                return Of("refused", "");
            }
        }
    }

    private static object Payloads(string kind, object table)
    {
        return Of("payload", Of(kind, table));
    }

    // Calls it as the listening thread does.
    private static void Hear(WholehandClient client, byte[] bytes)
    {
        var larger = new byte[64 * 1024]; // it reads into a buffer larger than the message
        Buffer.BlockCopy(bytes, 0, larger, 0, bytes.Length);
        typeof(WholehandClient).GetMethod("Hear", Inside).Invoke(client, new object[] { larger, bytes.Length, 1L });
    }

    // Payloads that no event passes on; a welcome opens a conversation.
    private static Payload Unheard(byte[] bytes)
    {
        var message = new ByteBuffer(bytes);
        if (!Wholehand.Words.IsMessage(message, bytes.Length)) return Payload.NONE;
        Payload kind = Message.GetRootAsMessage(message).PayloadType;
        return kind == Payload.Welcome || kind == Payload.Commissioning ? kind : Payload.NONE;
    }

    private static Welcome WelcomeOf(byte[] bytes)
    {
        return Message.GetRootAsMessage(new ByteBuffer(bytes)).PayloadAsWelcome();
    }

    // Replaces the message's values by those of the game's copies.
    private static void Copied(WholehandClient client, Dictionary<string, object> read)
    {
        var hand = new HandState { SentMonotonicNs = -1 };
        var world = new WorldSnapshot { SentMonotonicNs = -1 };
        if (!client.TryGetState(hand) || !client.TryGetWorld(world)) throw new InvalidOperationException("no copy");
        var copies = new Dictionary<string, object>
        {
            { "session", hand.Session }, { "endings", hand.Endings }, { "tick", hand.Tick }, { "time_s", hand.TimeS },
            { "sent_monotonic_ns", hand.SentMonotonicNs }, { "run_state", hand.RunState }, { "steering", hand.Steering },
            { "faults", hand.Faults }, { "latched_faults", hand.LatchedFaults }, { "authority", hand.Authority },
            { "alpha", hand.Alpha }, { "palm_body", hand.PalmBody }, { "palm_target_distance_m", hand.PalmTargetDistanceM },
            { "q_m", hand.DevicePosition }, { "q_s", hand.HandPosition }, { "theta", hand.JointAngles },
            { "intention", hand.Intention }, { "coupling", hand.Coupling }, { "exercise_effort", hand.ExerciseEffort },
            { "damping", hand.Damping }, { "sent", hand.Sent }, { "phi", hand.Phi }, { "values", hand.Values }
        };
        foreach (Dictionary<string, object> field in form.FieldsOf("WorldState"))
        {
            var name = (string)field["name"];
            if (!copies.TryGetValue(name, out object copy)) continue;
            var numbers = copy as Array;
            object value = numbers == null ? Form.Scalar(copy) : numbers.Cast<object>().Select(Form.Scalar).ToList();
            if (Form.IsDefault(field, (string)field["kind"], value)) read.Remove(name);
            else read[name] = value;
        }
        if (world.BodyCount > 0 || read.ContainsKey("bodies")) read["bodies"] = BodiesOf(world);
        if (world.ContactCount > 0 || read.ContainsKey("contacts")) read["contacts"] = Contacts(world);
    }

    private static List<object> BodiesOf(WorldSnapshot world)
    {
        return Enumerable.Range(0, world.BodyCount).Select(i => (object)new Dictionary<string, object>
        {
            { "position_m", Vector(world.BodyPositions[i]) },
            { "orientation_xyzw", Rotation(world.BodyOrientations[i]) }
        }).ToList();
    }

    private static List<object> Contacts(WorldSnapshot world)
    {
        return Enumerable.Range(0, world.ContactCount).Select(i => (object)new Dictionary<string, object>
        {
            { "capsule", (long)world.ContactCapsules[i] }, { "body", (long)world.ContactBodies[i] },
            { "point_m", Vector(world.ContactPoints[i]) }, { "force_n", Vector(world.ContactForces[i]) }
        }).ToList();
    }

    public static object Rotation(Rotation q)
    {
        return new Dictionary<string, object>
        {
            { "x", Form.Scalar((float)q.X) }, { "y", Form.Scalar((float)q.Y) }, { "z", Form.Scalar((float)q.Z) },
            { "w", Form.Scalar((float)q.W) }
        };
    }

    public static object Vector(Vector v)
    {
        return new Dictionary<string, object>
        {
            { "x", Form.Scalar((float)v.X) }, { "y", Form.Scalar((float)v.Y) }, { "z", Form.Scalar((float)v.Z) }
        };
    }

    // ---- orders ----

    private static object Write(Dictionary<string, object> entry)
    {
        var order = (string)entry["order"];
        var fields = (Dictionary<string, object>)entry["fields"];
        object token;
        using (var client = new WholehandClient(new ClientOptions { Token = fields.TryGetValue("token", out token) ? (string)token : "" }))
        {
            MethodInfo method = typeof(WholehandClient).GetMethod(order);
            if (method == null || method.DeclaringType != typeof(WholehandClient)) return null;
            Set(client, "connected", true);
            Set(client, "haveState", true); // Arm is refused before the first state
            Set(client, "command", unchecked((uint)(double)entry["id"] - 1));
            Dictionary<string, object>[] described = form.FieldsOf(order).ToArray();
            object[] values = method.GetParameters()
                .Select((parameter, i) => Given(parameter.ParameterType, described[i], fields)).ToArray();
            try
            {
                method.Invoke(client, values);
            }
            catch (TargetInvocationException e) when (e.InnerException is ArgumentException)
            {
                return null; // the client refuses it
            }
            return Convert.ToBase64String(Get<Queue<byte[]>>(client, "toSend").Dequeue());
        }
    }

    private static object Given(Type type, Dictionary<string, object> field, Dictionary<string, object> fields)
    {
        if (!fields.TryGetValue((string)field["name"], out object value)) field.TryGetValue("default", out value);
        if (type == typeof(string)) return value ?? "";
        if (type == typeof(float[])) return ((List<object>)value ?? new List<object>()).Select(Single).ToArray();
        if (type == typeof(double)) return BitConverter.Int64BitsToDouble(Convert.ToInt64((string)value, 16));
        if (type.IsArray) return Bodies.Given(type.GetElementType(), (List<object>)value ?? new List<object>());
        if (type.IsEnum) return Enum.ToObject(type, (long)(double)value);
        return Convert.ChangeType(value, type);
    }

    public static float Single(object bits)
    {
        return BitConverter.ToSingle(BitConverter.GetBytes(Convert.ToUInt32((string)bits, 16)), 0);
    }
}
