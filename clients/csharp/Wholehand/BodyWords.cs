using FlatBuffers;
using wholehand.protocol;

namespace Wholehand
{
    /// <summary>Orders to bodies as FlatBuffers, written from back to front.</summary>
    internal static class BodyWords
    {
        public static int PrepareShapes(FlatBufferBuilder b, ushort set, BodyShape[] pieces)
        {
            var tables = new Offset<Shape>[pieces.Length];
            for (int i = 0; i < pieces.Length; ++i) tables[i] = Piece(b, pieces[i]);
            VectorOffset vector = wholehand.protocol.PrepareShapes.CreatePiecesVector(b, tables);
            return wholehand.protocol.PrepareShapes.CreatePrepareShapes(b, set, vector).Value;
        }

        public static int Spawn(FlatBufferBuilder b, BodyToSpawn[] bodies)
        {
            var tables = new Offset<SpawnBody>[bodies.Length];
            for (int i = 0; i < bodies.Length; ++i) tables[i] = Spawned(b, bodies[i]);
            return wholehand.protocol.Spawn.CreateSpawn(b, wholehand.protocol.Spawn.CreateBodiesVector(b, tables)).Value;
        }

        public static int Remove(FlatBufferBuilder b, BodyId[] bodies)
        {
            wholehand.protocol.Remove.StartBodiesVector(b, bodies.Length);
            for (int i = bodies.Length - 1; i >= 0; --i) BodyName.CreateBodyName(b, bodies[i].Slot, bodies[i].Generation);
            return wholehand.protocol.Remove.CreateRemove(b, b.EndVector()).Value;
        }

        public static int Teleport(FlatBufferBuilder b, BodyAt[] bodies)
        {
            wholehand.protocol.Teleport.StartBodiesVector(b, bodies.Length);
            return wholehand.protocol.Teleport.CreateTeleport(b, Places(b, bodies, 0, bodies.Length)).Value;
        }

        public static int BodyTargets(FlatBufferBuilder b, BodyAt[] bodies, int first, int count)
        {
            wholehand.protocol.BodyTargets.StartBodiesVector(b, count);
            return wholehand.protocol.BodyTargets.CreateBodyTargets(b, Places(b, bodies, first, count)).Value;
        }

        public static int SetOwner(FlatBufferBuilder b, BodyOwnerChange[] bodies)
        {
            wholehand.protocol.SetOwner.StartBodiesVector(b, bodies.Length);
            for (int i = bodies.Length - 1; i >= 0; --i)
            {
                BodyHandover.CreateBodyHandover(b, bodies[i].Body.Slot, bodies[i].Body.Generation, bodies[i].Owner);
            }
            return wholehand.protocol.SetOwner.CreateSetOwner(b, b.EndVector()).Value;
        }

        // Writes the elements of a vector that was started.
        private static VectorOffset Places(FlatBufferBuilder b, BodyAt[] bodies, int first, int count)
        {
            for (int i = first + count - 1; i >= first; --i)
            {
                BodyAt at = bodies[i];
                BodyPlace.CreateBodyPlace(b, at.Body.Slot, at.Body.Generation, at.PositionM.X, at.PositionM.Y, at.PositionM.Z,
                    at.Orientation.X, at.Orientation.Y, at.Orientation.Z, at.Orientation.W);
            }
            return b.EndVector();
        }

        private static Offset<Shape> Piece(FlatBufferBuilder b, BodyShape s)
        {
            VectorOffset points = default(VectorOffset), triangles = default(VectorOffset);
            bool isMesh = s.PointsM != null && s.PointsM.Length > 0;
            if (isMesh)
            {
                Shape.StartPointsMVector(b, s.PointsM.Length);
                for (int i = s.PointsM.Length - 1; i >= 0; --i) Triple(b, s.PointsM[i]);
                points = b.EndVector();
                triangles = Shape.CreateTrianglesVector(b, s.Triangles ?? new uint[0]);
            }
            Shape.StartShape(b);
            Shape.AddType(b, s.Type);
            Shape.AddHalfExtentsM(b, Triple(b, s.HalfExtentsM));
            Shape.AddRadiusM(b, s.RadiusM);
            Shape.AddLengthM(b, s.LengthM);
            if (isMesh)
            {
                Shape.AddPointsM(b, points);
                Shape.AddTriangles(b, triangles);
            }
            Shape.AddInBody(b, Placed(b, s.PositionM, s.Orientation));
            return Shape.EndShape(b);
        }

        private static Offset<SpawnBody> Spawned(FlatBufferBuilder b, BodyToSpawn body)
        {
            SpawnBody.StartSpawnBody(b);
            SpawnBody.AddSlot(b, (ushort)body.Slot);
            SpawnBody.AddGeneration(b, body.Generation);
            SpawnBody.AddShapeSet(b, (ushort)body.ShapeSet);
            SpawnBody.AddOwner(b, body.Owner);
            SpawnBody.AddMassKg(b, body.MassKg);
            SpawnBody.AddFriction(b, body.Friction);
            SpawnBody.AddPose(b, Placed(b, body.PositionM, body.Orientation));
            SpawnBody.AddVelocityMS(b, Triple(b, body.VelocityMS));
            SpawnBody.AddRefuseOverlap(b, body.RefuseOverlap);
            return SpawnBody.EndSpawnBody(b);
        }

        private static Offset<Vec3> Triple(FlatBufferBuilder b, Vector v)
        {
            return Vec3.CreateVec3(b, v.X, v.Y, v.Z);
        }

        private static Offset<Pose> Placed(FlatBufferBuilder b, Vector p, Rotation q)
        {
            return Pose.CreatePose(b, p.X, p.Y, p.Z, q.X, q.Y, q.Z, q.W);
        }
    }
}
