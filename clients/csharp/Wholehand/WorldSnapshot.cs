using System;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>A copy of the bodies and contacts of a WorldState, owned by the game. Datagrams do not contain them:
    /// they come by WebSocket, 60 times a second. Copying the next state into it allocates nothing unless there are
    /// more bodies or contacts than ever before. SI, the program's frame (EngineAxes converts).</summary>
    public sealed class WorldSnapshot : Snapshot
    {
        /// <summary>Number of valid elements of the body arrays below: Scene.Bodies in their order, then the slots of a
        /// game.</summary>
        public int BodyCount;
        public Vector[] BodyPositions = new Vector[0];    // centre of mass [m]
        public Rotation[] BodyOrientations = new Rotation[0];

        /// <summary>Number of valid elements of the contact arrays below.</summary>
        public int ContactCount;
        public int[] ContactCapsules = new int[0];        // index into Scene.Capsules
        public int[] ContactBodies = new int[0];          // index into Scene.Bodies
        public Vector[] ContactPoints = new Vector[0];    // on the hand's surface [m]
        public Vector[] ContactForces = new Vector[0];    // on the hand [N]

        private const int MostBodies = 4096, MostContacts = 4096;
        private const float EmptyBelowM = -8; // empty slots are below this; a body of a game is within 5 m

        /// <summary>Whether the state has this body; false for an empty slot.</summary>
        public bool Has(int body)
        {
            return body >= 0 && body < BodyCount && BodyPositions[body].Z > EmptyBelowM;
        }

        internal override void CopyRest(WorldState s)
        {
            int bodies = s.BodiesLength, contacts = s.ContactsLength;
            if (bodies < 0 || bodies > MostBodies || contacts < 0 || contacts > MostContacts)
            {
                throw new InvalidOperationException("an array that no state has");
            }
            if (BodyPositions.Length < bodies)
            {
                BodyPositions = new Vector[bodies];
                BodyOrientations = new Rotation[bodies];
            }
            for (int i = 0; i < bodies; ++i)
            {
                Pose pose = s.Bodies(i).Value;
                QuatXyzw q = pose.OrientationXyzw;
                BodyPositions[i] = Of(pose.PositionM);
                BodyOrientations[i] = new Rotation(q.X, q.Y, q.Z, q.W);
            }
            BodyCount = bodies;
            if (ContactPoints.Length < contacts)
            {
                int room = Math.Max(64, 2 * contacts); // headroom, since the number changes with every tick
                ContactCapsules = new int[room];
                ContactBodies = new int[room];
                ContactPoints = new Vector[room];
                ContactForces = new Vector[room];
            }
            for (int i = 0; i < contacts; ++i)
            {
                ContactPoint contact = s.Contacts(i).Value;
                ContactCapsules[i] = contact.Capsule;
                ContactBodies[i] = contact.Body;
                ContactPoints[i] = Of(contact.PointM);
                ContactForces[i] = Of(contact.ForceN);
            }
            ContactCount = contacts;
        }

        private static Vector Of(Vec3 v)
        {
            return new Vector(v.X, v.Y, v.Z);
        }
    }
}
