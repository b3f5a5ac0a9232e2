using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A copy of the list of a game's bodies in the world, owned by the game: All has each of them once, by
    /// the name that the game gave it, and TryGetPlace its pose. Copying the next list into it allocates nothing unless
    /// there are more bodies than ever before.</summary>
    public sealed class BodySlots
    {
        public uint Session;                   // session of the bodies
        public int SceneBodies;                // number of the scene's own bodies, which come first in states

        /// <summary>Number of valid elements of All: first the bodies in slots that the game chose, then those with
        /// numbers, in the order of slots and of numbers.</summary>
        public int AllCount;
        public BodyInWorld[] All = new BodyInWorld[0];

        /// <summary>Number of valid elements of the arrays below, which are the loop's slots in order.
        /// A body with a number has the slot's generation here, not the game's.</summary>
        public int Count;
        public BodyId[] Bodies = new BodyId[0];
        public SlotState[] States = new SlotState[0];
        public uint[] Shapes = new uint[0];    // see WholehandClient.TryGetShapes

        internal long Number;                  // number of the message; 0: none
        internal bool InOrder = true;          // whether All is sorted; a damaged list may have its slots in any order

        /// <summary>Pose of body <paramref name="i"/> of All: its centre of mass, in the world. False if neither the
        /// state nor the list contains it at present: then the body stays where it was drawn.</summary>
        public bool TryGetPlace(int i, WorldSnapshot world, out Vector positionM, out Rotation orientation)
        {
            positionM = All[i].PositionM;
            orientation = All[i].Orientation;
            if (All[i].State == SlotState.Parked) return All[i].Stands;
            int pose = PoseOf((uint)All[i].LoopSlot);
            if (world.Session != Session || !world.Has(pose)) return false;
            positionM = world.BodyPositions[pose];
            orientation = world.BodyOrientations[pose];
            return true;
        }

        /// <summary>Index into WorldSnapshot.BodyPositions. It may be beyond BodyCount: then no state contains it
        /// yet.</summary>
        public int PoseOf(uint slot)
        {
            return SceneBodies + (int)slot;
        }

        /// <summary>Index into All; -1: no such body is in the world.</summary>
        public int FindInAll(BodyId body)
        {
            if (!InOrder) return FindOneByOne(body);
            int low = 0, high = AllCount - 1;
            while (low <= high)
            {
                int middle = (low + high) / 2;
                BodyId there = All[middle].Id;
                if (there.Slot == body.Slot) return there.Generation == body.Generation ? middle : -1;
                if (there.Slot < body.Slot) low = middle + 1;
                else high = middle - 1;
            }
            return -1;
        }

        /// <summary>Index into Bodies, States and Shapes for a body without a number; -1: no such body is in the
        /// world.</summary>
        public int Find(BodyId body)
        {
            for (int i = 0; i < Count; ++i)
            {
                if (Bodies[i].Slot == body.Slot && Bodies[i].Generation == body.Generation) return i;
            }
            return -1;
        }

        private int FindOneByOne(BodyId body)
        {
            for (int i = 0; i < AllCount; ++i)
            {
                if (All[i].Id.Slot == body.Slot && All[i].Id.Generation == body.Generation) return i;
            }
            return -1;
        }

        internal void Resize(int count)
        {
            if (Bodies.Length < count)
            {
                Bodies = new BodyId[count];
                States = new SlotState[count];
                Shapes = new uint[count];
            }
            Count = count;
        }

        internal void ResizeAll(int count)
        {
            if (All.Length < count) All = new BodyInWorld[count];
            AllCount = count;
        }

        internal void CopyFrom(BodySlots other)
        {
            Resize(other.Count);
            System.Array.Copy(other.Bodies, Bodies, Count);
            System.Array.Copy(other.States, States, Count);
            System.Array.Copy(other.Shapes, Shapes, Count);
            ResizeAll(other.AllCount);
            System.Array.Copy(other.All, All, AllCount);
            InOrder = other.InOrder;
            Session = other.Session;
            SceneBodies = other.SceneBodies;
            Number = other.Number;
        }
    }
}
