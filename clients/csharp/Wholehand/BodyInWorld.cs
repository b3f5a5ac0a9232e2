using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A body of a game that is in the world.</summary>
    public struct BodyInWorld
    {
        /// <summary>The name that the game gave it: its slot, or its number from 1000 on, and its generation.</summary>
        public BodyId Id;
        public uint Shapes;                    // see WholehandClient.TryGetShapes

        /// <summary>The loop's slot that it has, or will get; -1: none, it stands still. A body with a number gets a
        /// slot while the hand is near.</summary>
        public int LoopSlot;
        public SlotState State;                // in LoopSlot; Parked: it is not there, or not yet
        public Whereabouts Whereabouts;        // for a body with a number; InSlot for all others

        /// <summary>Position of a body with a number when it was last reported. BodySlots.TryGetPlace gives the present
        /// one.</summary>
        public Vector PositionM;
        public Rotation Orientation;

        internal bool Stands;                  // its reported pose is valid; false after it was in a slot
    }
}
