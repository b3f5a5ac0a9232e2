using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A convex piece of a body to come. SI, the program's axes; cylinders and capsules lie along z. The frame is
    /// the game's choice: its axes become those of the body.</summary>
    public sealed class BodyShape
    {
        public ShapeType Type;
        public Vector HalfExtentsM;            // box
        public float RadiusM;                  // sphere, cylinder, capsule
        public float LengthM;                  // cylinder: height; capsule: between the centres of its caps
        public Vector[] PointsM;               // convex mesh
        public uint[] Triangles;               // three indices of points each, of either winding
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

        /// <param name="lengthM">Between the centres of the caps.</param>
        public static BodyShape Capsule(float radiusM, float lengthM)
        {
            return new BodyShape { Type = ShapeType.Capsule, RadiusM = radiusM, LengthM = lengthM };
        }

        /// <summary>Convex and closed.</summary>
        public static BodyShape Mesh(Vector[] pointsM, uint[] triangles)
        {
            return new BodyShape { Type = ShapeType.ConvexMesh, PointsM = pointsM, Triangles = triangles };
        }
    }

    /// <summary>A body by its slot, and by the generation that names it among those that the slot holds one after
    /// another. In place of a slot a game may choose a number from 1000 to 32767: such bodies, up to
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
        public bool RefuseOverlap;             // refused instead of a ghost where it overlaps something

        public BodyId Id { get { return new BodyId(Slot, Generation); } }
    }

    /// <summary>Where a body is put or pulled: its centre of mass, in the world [m].</summary>
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

        /// <summary>Upright.</summary>
        public BodyAt(BodyId body, Vector positionM) : this(body, positionM, new Rotation(0, 0, 0, 1))
        {
        }
    }

    /// <summary>Who moves a body from now on.</summary>
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

    /// <summary>An item of an order to bodies that was refused; all others were handed to the loop.</summary>
    public struct RefusedBody
    {
        public int Index;                      // in the order's arguments
        public int Slot;                       // -1: of shapes
        public BodyRefusal Refusal;
        public string Reason;                  // for a person, in English
    }

    /// <summary>What became of a body; docs/protocol.md, "Bodies of a game".</summary>
    public enum BodyEventKind
    {
        Appeared,      // a ghost: drawn, but touches nothing
        Solid,         // collides from now on
        LettingGo,     // presses the hand less and less
        Left,          // the slot is empty
        Quarantined,   // too fast, or more than 5 m away: taken out
        Refused,       // an order was refused by the loop
        Touched        // touches the hand, after 0.1 s or more without contact
    }

    public struct BodyEvent
    {
        public BodyEventKind Kind;
        public ulong Tick;
        public int Slot;                       // of the loop; -1: of shapes
        public uint Generation;                // in that slot; 0 of Refused

        /// <summary>As the game named it: of a body with a number, that number and the game's own generation. Such a body
        /// also appears and leaves when it gets a slot and gives it back: BodySlots.All says whether it is in the
        /// world.</summary>
        public BodyId Body;
        public BodyRefusal Refusal;            // of Refused
        public float ImpulseNs;                // of Touched: on the hand, within the first 10 ms
    }
}
