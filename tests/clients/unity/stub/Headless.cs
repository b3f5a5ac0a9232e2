using System.Runtime.CompilerServices;
using System;
using System.Collections.Generic;
using System.Reflection;

[assembly: InternalsVisibleTo("HeadlessTests")]

namespace UnityEngine.Headless
{
    /// <summary>Runs components in the order of Unity's manual ("Order of execution for event functions"): Awake and
    /// OnEnable at once, Start before the first step or frame, then FixedUpdate and physics, Update, LateUpdate, gizmos
    /// and GUI; within each by DefaultExecutionOrder. A frame itself allocates nothing.</summary>
    public static class Player
    {
        private sealed class Script
        {
            public MonoBehaviour Behaviour;
            public int Order;
            public bool Started;
            public Action Start, FixedUpdate, Update, LateUpdate, Gizmos, Gui;
        }

        internal static readonly List<Rigidbody> Rigidbodies = new List<Rigidbody>();
        private static readonly List<Script> scripts = new List<Script>();
        private static readonly List<Script> added = new List<Script>();
        private static readonly List<Object> dying = new List<Object>();

        /// <summary>Runs one frame with so many physics steps.</summary>
        public static void Frame(int fixedSteps, float fixedPeriodS)
        {
            for (int step = 0; step < fixedSteps; ++step)
            {
                Begin();
                for (int i = 0; i < scripts.Count; ++i) Invoke(scripts[i], scripts[i].FixedUpdate);
                StepPhysics(fixedPeriodS);
            }
            Begin();
            for (int i = 0; i < scripts.Count; ++i) Invoke(scripts[i], scripts[i].Update);
            for (int i = 0; i < scripts.Count; ++i) Invoke(scripts[i], scripts[i].LateUpdate);
            for (int i = 0; i < scripts.Count; ++i) Invoke(scripts[i], scripts[i].Gizmos);
            GUILayout.Labels.Clear();
            for (int i = 0; i < scripts.Count; ++i) Invoke(scripts[i], scripts[i].Gui);
            EndDying();
        }

        /// <summary>Destroys all objects, as when a game is closed.</summary>
        public static void Quit()
        {
            foreach (Script script in scripts.ToArray()) End(script.Behaviour);
            foreach (Script script in added.ToArray()) End(script.Behaviour);
            EndDying();
            scripts.Clear();
            added.Clear();
            Rigidbodies.Clear();
            Debug.Errors.Clear();
        }

        private static void EndDying()
        {
            for (int i = 0; i < dying.Count; ++i) End(dying[i]); // an ending object may destroy more objects
            dying.Clear();
        }

        internal static void Begin(MonoBehaviour behaviour)
        {
            Call(behaviour, "Awake");
            if (behaviour.enabled) Call(behaviour, "OnEnable");
            object[] orders = behaviour.GetType().GetCustomAttributes(typeof(DefaultExecutionOrder), true);
            added.Add(new Script
            {
                Behaviour = behaviour,
                Order = orders.Length == 0 ? 0 : ((DefaultExecutionOrder)orders[0]).order,
                Start = Of(behaviour, "Start"), FixedUpdate = Of(behaviour, "FixedUpdate"), Update = Of(behaviour, "Update"),
                LateUpdate = Of(behaviour, "LateUpdate"), Gizmos = Of(behaviour, "OnDrawGizmos"), Gui = Of(behaviour, "OnGUI")
            });
        }

        internal static void DestroyAfterFrame(Object o)
        {
            dying.Add(o);
        }

        internal static void Call(MonoBehaviour behaviour, string message)
        {
            Action call = Of(behaviour, message);
            if (call != null) call();
        }

        private static Action Of(MonoBehaviour behaviour, string message)
        {
            MethodInfo method = behaviour.GetType().GetMethod(message,
                BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic, null, Type.EmptyTypes, null);
            return method == null ? null : (Action)Delegate.CreateDelegate(typeof(Action), behaviour, method);
        }

        private static void Begin()
        {
            if (added.Count > 0)
            {
                scripts.AddRange(added);
                added.Clear();
                var sorted = new List<Script>(scripts);
                sorted.Sort((a, b) => a.Order != b.Order ? a.Order - b.Order : scripts.IndexOf(a) - scripts.IndexOf(b));
                scripts.Clear();
                scripts.AddRange(sorted);
            }
            for (int i = 0; i < scripts.Count; ++i)
            {
                if (scripts[i].Started || !scripts[i].Behaviour.enabled) continue;
                scripts[i].Started = true;
                Invoke(scripts[i], scripts[i].Start);
            }
        }

        private static void Invoke(Script script, Action message)
        {
            if (message == null || !script.Started || script.Behaviour.Destroyed || !script.Behaviour.enabled) return;
            try
            {
                message();
            }
            catch (Exception e)
            {
                Debug.LogException(e); // as in Unity, the other scripts continue
            }
        }

        private static void StepPhysics(float periodS)
        {
            for (int i = 0; i < Rigidbodies.Count; ++i)
            {
                Rigidbody body = Rigidbodies[i];
                if (!body.Moved || body.Destroyed) continue;
                body.Velocity = (1.0f / periodS) * (body.NextPosition - body.transform.position);
                Transform above = body.transform.parent;
                Vector3 at = body.NextPosition;
                Quaternion turn = body.NextRotation;
                body.transform.localPosition = above == null ? at : Quaternion.Inverse(above.rotation) * (at - above.position);
                body.transform.localRotation = above == null ? turn : Quaternion.Inverse(above.rotation) * turn;
                body.Moved = false;
            }
        }

        private static void End(Object o)
        {
            if (!o) return;
            var behaviour = o as MonoBehaviour;
            if (behaviour != null && behaviour.enabled) Call(behaviour, "OnDisable");
            if (behaviour != null) Call(behaviour, "OnDestroy");
            var mesh = o as Mesh;
            if (!ReferenceEquals(mesh, null)) --Mesh.Alive;
            o.Destroyed = true;
            var holder = o as GameObject;
            if (!ReferenceEquals(holder, null))
            {
                holder.transform.SetParent(null, false);
                foreach (Component c in holder.Components) End(c);
                foreach (Transform child in holder.transform.Children.ToArray()) End(child.gameObject);
                holder.transform.Destroyed = true;
            }
            scripts.RemoveAll(s => ReferenceEquals(s.Behaviour, o));
            Rigidbodies.RemoveAll(r => ReferenceEquals(r, o));
        }
    }
}
