using NUnit.Framework;
using UnityEngine;

namespace Wholehand.Unity.Tests
{
    public sealed class ConversionTests
    {
        private const float Near = 1e-6f;

        [Test]
        public void Directions_AreThoseOfTheManual()
        {
            Assert.Less((new Vector(1, 0, 0).ToVector3() - Vector3.forward).magnitude, Near, "away from the person");
            Assert.Less((new Vector(0, 1, 0).ToVector3() - Vector3.left).magnitude, Near, "left");
            Assert.Less((new Vector(0, 0, 1).ToVector3() - Vector3.up).magnitude, Near, "up");
        }

        [Test]
        public void QuarterTurnToTheLeft_IsMinusNinetyDegreesAboutUp()
        {
            // A rotation about z in Wholehand; Unity's is clockwise about y, seen from above.
            float s = Mathf.Sqrt(0.5f);
            Quaternion turn = new Rotation(0, 0, s, s).ToQuaternion();
            Assert.Less((turn * Vector3.forward - Vector3.left).magnitude, Near, "forward becomes left");
            Assert.Less(Quaternion.Angle(turn, Quaternion.AngleAxis(-90.0f, Vector3.up)), 0.1f, "as Unity says it");
        }

        [Test]
        public void ThereAndBack_IsWhereItWas()
        {
            var v = new Vector3(0.1f, -0.2f, 0.3f);
            Assert.Less((v.ToWholehand().ToVector3() - v).magnitude, Near, "vector");
            var q = new Quaternion(0.1f, 0.7f, -0.1f, 0.7f);
            Quaternion back = q.ToWholehand().ToQuaternion();
            Assert.Less(Mathf.Abs(q.x - back.x) + Mathf.Abs(q.y - back.y) + Mathf.Abs(q.z - back.z), Near, "rotation");
        }
    }
}
