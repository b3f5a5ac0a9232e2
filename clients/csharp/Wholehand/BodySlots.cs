using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A copy of which slots hold bodies of a game, that the game owns. The pose of the body of a slot is that of
    /// index BodySlots.PoseOf(slot) of a WorldSnapshot of the same session. Taking the next one into it allocates nothing
    /// unless there are more bodies than ever before.</summary>
    public sealed class BodySlots
    {
        public uint Session;                   // whose bodies they are
        public int SceneBodies;                // bodies of the scene itself: they come first in states

        /// <summary>Of the arrays below, how many bodies are valid; in the order of the slots.</summary>
        public int Count;
        public BodyId[] Bodies = new BodyId[0];
        public SlotState[] States = new SlotState[0];
        public uint[] Shapes = new uint[0];    // WholehandClient.TryGetShapes

        internal long Number;                  // of the message; 0: none

        /// <summary>Index into WorldSnapshot.BodyPositions; it may be beyond BodyCount: then no state has it yet.</summary>
        public int PoseOf(uint slot)
        {
            return SceneBodies + (int)slot;
        }

        /// <summary>Index into the arrays above; -1: no such body is in the world.</summary>
        public int Find(BodyId body)
        {
            for (int i = 0; i < Count; ++i)
            {
                if (Bodies[i].Slot == body.Slot && Bodies[i].Generation == body.Generation) return i;
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

        internal void CopyFrom(BodySlots other)
        {
            Resize(other.Count);
            System.Array.Copy(other.Bodies, Bodies, Count);
            System.Array.Copy(other.States, States, Count);
            System.Array.Copy(other.Shapes, Shapes, Count);
            Session = other.Session;
            SceneBodies = other.SceneBodies;
            Number = other.Number;
        }
    }
}
