using UnityEditor;
using UnityEngine;

namespace Wholehand.Unity.Editor
{
    /// <summary>GameObject &gt; Wholehand: a connection with the hand and the bodies below it.</summary>
    public static class WholehandMenu
    {
        [MenuItem("GameObject/Wholehand/Hand and World", false, 10)]
        public static void CreateHandAndWorld(MenuCommand command)
        {
            var root = new GameObject("Wholehand", typeof(WholehandConnection));
            var hand = new GameObject("Hand", typeof(WholehandHand), typeof(WholehandGizmos));
            var world = new GameObject("World", typeof(WholehandWorld));
            GameObjectUtility.SetParentAndAlign(root, command.context as GameObject);
            GameObjectUtility.SetParentAndAlign(hand, root);
            GameObjectUtility.SetParentAndAlign(world, root);
            Undo.RegisterCreatedObjectUndo(root, "Create Wholehand");
            Selection.activeGameObject = root;
        }
    }
}
