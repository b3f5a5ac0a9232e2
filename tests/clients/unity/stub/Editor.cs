using System;
using UnityEngine;

namespace UnityEditor
{
    public class Editor : UnityEngine.Object
    {
        public UnityEngine.Object target { get; set; }
        public virtual void OnInspectorGUI() { }
        public virtual bool RequiresConstantRepaint() { return false; }
        public bool DrawDefaultInspector() { return false; }
    }

    public sealed class CustomEditor : Attribute { public CustomEditor(Type type) { } }
    public sealed class MenuItem : Attribute { public MenuItem(string path, bool isValidate, int priority) { } }
    public sealed class MenuCommand { public UnityEngine.Object context; }
    public enum MessageType { None, Info, Warning, Error }

    public static class EditorGUILayout
    {
        public static string Shown = "";
        public static void HelpBox(string text, MessageType type) { Shown = type + ": " + text; }
    }

    public static class Undo
    {
        public static void RegisterCreatedObjectUndo(UnityEngine.Object o, string name) { }
    }

    public static class Selection
    {
        public static GameObject activeGameObject { get; set; }
    }

    public static class GameObjectUtility
    {
        public static void SetParentAndAlign(GameObject child, GameObject parent)
        {
            if (parent != null) child.transform.SetParent(parent.transform, false);
        }
    }
}
