using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A body of a game that is in the world.</summary>
    public struct BodyInWorld
    {
        /// <summary>As the game named it: its slot, or its number from 1000 on, and its generation.</summary>
        public BodyId Id;
        public uint Shapes;                    // WholehandClient.TryGetShapes

        /// <summary>Of the loop, or on its way there; -1: none, it stands still. A body with a number gets one while the
        /// hand is near.</summary>
        public int LoopSlot;
        public SlotState State;                // in LoopSlot; Parked: it is not there (yet)
        public Whereabouts Whereabouts;        // of a body with a number; InSlot of all others

        /// <summary>Of a body with a number: where it stood when that was last said. BodySlots.TryGetPlace knows
        /// better.</summary>
        public Vector PositionM;
        public Rotation Orientation;

        internal bool Stands;                  // there, as far as is known; not since it was in a slot
    }
}
