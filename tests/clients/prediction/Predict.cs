using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using Wholehand;

/// <summary>Predict.exe JOB.json ANSWER.json: the C# client's MotionPredictor (test_prediction.py).</summary>
public static class Predict
{
    public static int Main(string[] arguments)
    {
        var job = (Dictionary<string, object>)Json.Read(File.ReadAllText(arguments[0]));
        File.WriteAllText(arguments[1], Json.Write(((List<object>)job["runs"]).Select(run => (object)Answer((List<object>)run)).ToList()));
        return 0;
    }

    private static List<object> Answer(List<object> frames)
    {
        var motion = new MotionPredictor();
        var answers = new List<object>();
        float[] joints = null;
        foreach (Dictionary<string, object> frame in frames.Cast<Dictionary<string, object>>())
        {
            foreach (List<object> reported in ((List<object>)frame["states"]).Cast<List<object>>())
            {
                var state = new HandState
                {
                    Session = 1, TimeS = (double)reported[0], SentMonotonicNs = (long)(double)reported[1], ReceivedNs = (long)(double)reported[2],
                    JointAngles = ((List<object>)reported[3]).Select(Convert.ToSingle).ToArray()
                };
                if (joints == null) joints = new float[state.JointAngles.Length];
                motion.Add(state);
            }
            if (!motion.TryPredict((long)(double)frame["at_ns"], joints)) throw new Exception("no prediction");
            answers.Add(joints.Select(joint => (object)(double)joint).ToList());
        }
        return answers;
    }
}
