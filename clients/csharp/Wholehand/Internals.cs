using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("WholehandTests")]
