using System;

namespace NUnit.Framework
{
    public sealed class TestAttribute : Attribute { }

    public sealed class AssertionException : Exception { public AssertionException(string message) : base(message) { } }

    public static class Assert
    {
        public static void Less(float smaller, float larger, string message)
        {
            if (!(smaller < larger)) throw new AssertionException(message + ": " + smaller + " is not less than " + larger);
        }
    }
}
