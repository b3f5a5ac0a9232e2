using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("WholehandTests")]
[assembly: InternalsVisibleTo("Golden")]
