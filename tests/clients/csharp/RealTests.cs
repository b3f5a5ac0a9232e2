using Wholehand;
using wholehand.protocol;

/// <summary>The client with the real program: `wholehand run --udp`, the cocktail bar, played by its virtual
/// patient.</summary>
[Tests]
public static class RealTests
{
    public static void StatesOfTheCocktailBar_ArriveCompleteAndInOrder()
    {
        using (var program = new RealProgram())
        using (var client = new WholehandClient(new ClientOptions { Port = program.Port }))
        {
            client.Connect();
            Check.Until(() => client.LatestScene.HasValue && client.Statistics.Received > 500, "states");
            Scene scene = client.LatestScene.Value;
            Check.Equal("cocktail-bar", scene.ExerciseName, "exercise");
            var state = new HandState();
            Check.True(client.TryGetState(state), "a state");
            Check.Equal(scene.AxesLength, state.HandPosition.Length, "axes");
            Check.Equal(scene.JointNamesLength, state.JointAngles.Length, "joints");
            Check.Equal(scene.ValueNamesLength, state.Values.Length, "values");
            Check.Equal(RunState.Rendering, state.RunState, "it renders");
            States.Judge(client, "wholehand run at 1 kHz to mono");
        }
    }

    public static void ProgramNeverArmed_CanBeArmedWithoutDatagrams()
    {
        using (var program = new RealProgram("--port 0 --wait"))
        using (var client = new WholehandClient(new ClientOptions { Port = program.Port }))
        {
            client.Connect();
            var state = new HandState();
            Check.Until(() => client.TryGetState(state), "a state of a program that has not ticked");
            Check.Equal(0UL, state.Tick, "tick");
            Check.True(state.Endings > 0, "the number that Arm is to name");
            Answers.Accepted(client.TakeControls());
            Answers.Accepted(client.Arm(state.Endings, state.Basis));
            Check.Until(() => client.TryGetState(state) && state.RunState == RunState.Rendering, "it renders");
        }
    }
}
