using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A convex piece of a body. SI units, the program's axes; cylinders and capsules lie along z. The game
    /// chooses the frame: its axes become those of the body.</summary>
    public sealed class BodyShape
    {
        public ShapeType Type;
        public Vector HalfExtentsM;            // box
        public float RadiusM;                  // sphere, cylinder, capsule
        public float LengthM;                  // cylinder: height; capsule: between the centres of its caps
        public Vector[] PointsM;               // convex mesh
        public uint[] Triangles;               // three indices of points for each, in either winding order
        public Vector PositionM;               // in the game's frame
        public Rotation Orientation = new Rotation(0, 0, 0, 1);

        public static BodyShape Box(Vector sizeM)
        {
            return new BodyShape
            {
                Type = ShapeType.Box, HalfExtentsM = new Vector(0.5f * sizeM.X, 0.5f * sizeM.Y, 0.5f * sizeM.Z)
            };
        }

        public static BodyShape Ball(float radiusM)
        {
            return new BodyShape { Type = ShapeType.Sphere, RadiusM = radiusM };
        }

        public static BodyShape Cylinder(float radiusM, float heightM)
        {
            return new BodyShape { Type = ShapeType.Cylinder, RadiusM = radiusM, LengthM = heightM };
        }

        /// <param name="lengthM">Distance between the centres of the caps.</param>
        public static BodyShape Capsule(float radiusM, float lengthM)
        {
            return new BodyShape { Type = ShapeType.Capsule, RadiusM = radiusM, LengthM = lengthM };
        }

        /// <summary>A convex and closed mesh.</summary>
        public static BodyShape Mesh(Vector[] pointsM, uint[] triangles)
        {
            return new BodyShape { Type = ShapeType.ConvexMesh, PointsM = pointsM, Triangles = triangles };
        }
    }

    /// <summary>Names a body by its slot, and by a generation that distinguishes successive bodies of the
    /// slot. Instead of a slot a game may choose a number from 1000 to 32767: such bodies, up to
    /// Scene.Budget.Registered, get slots while the hand is near.</summary>
    public struct BodyId
    {
        public const uint FirstNumber = 1000, LastNumber = 32767;

        public uint Slot, Generation;

        public bool IsNumber { get { return Slot >= FirstNumber && Slot <= LastNumber; } }

        public BodyId(uint slot, uint generation)
        {
            Slot = slot;
            Generation = generation;
        }
    }

    /// <summary>A body to spawn. The pose is that of the centre of mass, in the world.</summary>
    public sealed class BodyToSpawn
    {
        public uint Slot;                      // below Scene.Budget.Slots, and empty; or a number (BodyId)
        public uint Generation = 1;            // 1 to 16777215
        public uint ShapeSet;
        public BodyOwner Owner = BodyOwner.Loop;
        public float MassKg = 0.1f;
        public float Friction = 0.8f;          // Coulomb coefficient against the hand
        public Vector PositionM;
        public Rotation Orientation = new Rotation(0, 0, 0, 1);
        public Vector VelocityMS;              // when it becomes solid; owner Loop only
        public bool RefuseOverlap;             // refused, instead of becoming a ghost, if it overlaps something

        public BodyId Id { get { return new BodyId(Slot, Generation); } }
    }

    /// <summary>A target pose of a body: its centre of mass, in the world [m].</summary>
    public struct BodyAt
    {
        public BodyId Body;
        public Vector PositionM;
        public Rotation Orientation;

        public BodyAt(BodyId body, Vector positionM, Rotation orientation)
        {
            Body = body;
            PositionM = positionM;
            Orientation = orientation;
        }

        /// <summary>A pose without rotation.</summary>
        public BodyAt(BodyId body, Vector positionM) : this(body, positionM, new Rotation(0, 0, 0, 1))
        {
        }
    }

    /// <summary>Changes the owner that moves a body.</summary>
    public struct BodyOwnerChange
    {
        public BodyId Body;
        public BodyOwner Owner;

        public BodyOwnerChange(BodyId body, BodyOwner owner)
        {
            Body = body;
            Owner = owner;
        }
    }

    /// <summary>A refused item of an order to bodies; all other items were handed to the loop.</summary>
    public struct RefusedBody
    {
        public int Index;                      // index in the order's arguments
        public int Slot;                       // -1: a refused shape set
        public BodyRefusal Refusal;
        public string Reason;                  // for a person, in English
    }

    /// <summary>An event of a body; docs/protocol.md, "Bodies of a game".</summary>
    public enum BodyEventKind
    {
        Appeared,      // it is a ghost: drawn, but it touches nothing
        Solid,         // it collides from now on
        LettingGo,     // its force on the hand is being reduced
        Left,          // the slot is empty
        Quarantined,   // it was removed: too fast, or more than 5 m away
        Refused,       // the loop refused an order
        Touched        // it touches the hand, after 0.1 s or more without contact
    }

    public struct BodyEvent
    {
        public BodyEventKind Kind;
        public ulong Tick;
        public int Slot;                       // the loop's slot; -1: a shape set
        public uint Generation;                // generation in that slot; 0 for Refused

        /// <summary>The name that the game gave it: for a body with a number, that number and the game's own
        /// generation. Such a body also appears and leaves when it gets a slot and gives it back: BodySlots.All shows
        /// whether it is in the world.</summary>
        public BodyId Body;
        public BodyRefusal Refusal;            // for Refused
        public float ImpulseNs;                // for Touched: impulse on the hand within the first 10 ms
    }
}
