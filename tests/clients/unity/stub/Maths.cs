// A stand-in for the part of UnityEngine that the package uses, written from Unity's manual, so that mono can compile
// and run the package without Unity. Signatures are Unity 2021.3's; conventions too: left-handed, y up.
using System;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 zero { get { return new Vector3(0, 0, 0); } }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public static Vector3 up { get { return new Vector3(0, 1, 0); } }
        public static Vector3 left { get { return new Vector3(-1, 0, 0); } }
        public static Vector3 right { get { return new Vector3(1, 0, 0); } }
        public static Vector3 forward { get { return new Vector3(0, 0, 1); } }

        public float magnitude { get { return (float)Math.Sqrt(Dot(this, this)); } }

        public Vector3 normalized { get { return magnitude > 1e-5f ? this * (1.0f / magnitude) : zero; } }

        public static float Dot(Vector3 a, Vector3 b)
        {
            return a.x * b.x + a.y * b.y + a.z * b.z;
        }

        public static Vector3 Cross(Vector3 a, Vector3 b)
        {
            return new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
        }

        public static Vector3 Scale(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x * b.x, a.y * b.y, a.z * b.z);
        }

        public static Vector3 operator +(Vector3 a, Vector3 b) { return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z); }
        public static Vector3 operator -(Vector3 a, Vector3 b) { return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z); }
        public static Vector3 operator -(Vector3 a) { return new Vector3(-a.x, -a.y, -a.z); }
        public static Vector3 operator *(Vector3 a, float s) { return new Vector3(s * a.x, s * a.y, s * a.z); }
        public static Vector3 operator *(float s, Vector3 a) { return a * s; }
    }

    public struct Quaternion
    {
        public float x, y, z, w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static Quaternion identity { get { return new Quaternion(0, 0, 0, 1); } }

        public static Quaternion Inverse(Quaternion q)
        {
            return new Quaternion(-q.x, -q.y, -q.z, q.w);
        }

        /// <summary>[degrees]</summary>
        public static Quaternion AngleAxis(float angle, Vector3 axis)
        {
            double half = angle * Math.PI / 360.0;
            Vector3 v = axis.normalized * (float)Math.Sin(half);
            return new Quaternion(v.x, v.y, v.z, (float)Math.Cos(half));
        }

        /// <summary>[degrees]</summary>
        public static float Angle(Quaternion a, Quaternion b)
        {
            double dot = Math.Abs(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w);
            return (float)(2.0 * Math.Acos(Math.Min(1.0, dot)) * 180.0 / Math.PI);
        }

        public static Quaternion FromToRotation(Vector3 from, Vector3 to)
        {
            Vector3 a = from.normalized, b = to.normalized, axis = Vector3.Cross(a, b);
            float w = 1.0f + Vector3.Dot(a, b);
            if (w < 1e-6f) // opposite vectors: half a turn about any perpendicular axis
            {
                axis = Vector3.Cross(a, Math.Abs(a.x) < 0.9f ? Vector3.right : Vector3.up).normalized;
                w = 0.0f;
            }
            float n = (float)Math.Sqrt(Vector3.Dot(axis, axis) + w * w);
            return new Quaternion(axis.x / n, axis.y / n, axis.z / n, w / n);
        }

        /// <summary>Applies b first, then a.</summary>
        public static Quaternion operator *(Quaternion a, Quaternion b)
        {
            return new Quaternion(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z,
                a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x,
                a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
        }

        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            var u = new Vector3(q.x, q.y, q.z);
            Vector3 t = 2.0f * Vector3.Cross(u, v);
            return v + q.w * t + Vector3.Cross(u, t);
        }
    }

    public struct Matrix4x4
    {
        internal Vector3 Position;
        internal Quaternion Rotation;
    }

    public struct Color
    {
        public float r, g, b, a;

        public Color(float r, float g, float b)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            a = 1.0f;
        }

        public static Color gray { get { return new Color(0.5f, 0.5f, 0.5f); } }
        public static Color red { get { return new Color(1, 0, 0); } }
        public static Color green { get { return new Color(0, 1, 0); } }
        public static Color yellow { get { return new Color(1, 0.92f, 0.016f); } }
    }

    public static class ColorUtility
    {
        public static bool TryParseHtmlString(string text, out Color color)
        {
            color = new Color();
            int rgb;
            if (text.Length != 7 || text[0] != '#'
                || !int.TryParse(text.Substring(1), System.Globalization.NumberStyles.HexNumber, null, out rgb)) return false;
            color = new Color((rgb >> 16) / 255.0f, (rgb >> 8 & 255) / 255.0f, (rgb & 255) / 255.0f);
            return true;
        }
    }

    public static class Mathf
    {
        public const float PI = (float)Math.PI;
        public static float Sin(float x) { return (float)Math.Sin(x); }
        public static float Cos(float x) { return (float)Math.Cos(x); }
        public static float Sqrt(float x) { return (float)Math.Sqrt(x); }
        public static float Abs(float x) { return Math.Abs(x); }
        public static float Clamp(float x, float lower, float upper) { return Math.Max(lower, Math.Min(upper, x)); }
        public static float Max(float a, float b) { return Math.Max(a, b); }
        public static float Clamp01(float x) { return Clamp(x, 0.0f, 1.0f); }
    }
}
