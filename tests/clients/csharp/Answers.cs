using System.Threading.Tasks;
using Wholehand;

/// <summary>Waits for the program's answer to a command and checks it.</summary>
internal static class Answers
{
    public static CommandReply Ended(Task<CommandReply> command)
    {
        Check.True(command.Wait(300000), "the command is answered");
        return command.Result;
    }

    public static void Accepted(Task<CommandReply> command)
    {
        CommandReply reply = Ended(command);
        Check.True(reply.Accepted, "refused: " + reply.Reason);
    }

    public static string Refused(Task<CommandReply> command)
    {
        CommandReply reply = Ended(command);
        Check.True(!reply.Accepted && reply.Reason != "", "accepted, or refused without a reason");
        return reply.Reason;
    }
}
