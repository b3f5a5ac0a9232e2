using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Rendering;

namespace Wholehand.Unity
{
    /// <summary>Coloured meshes for any render pipeline.</summary>
    internal static class Appearance
    {
        private static Material standard;

        /// <summary>The pipeline's default material; in the built-in pipeline one with the shader Standard.</summary>
        public static Material Default
        {
            get
            {
                RenderPipelineAsset pipeline = GraphicsSettings.currentRenderPipeline;
                if (pipeline != null && pipeline.defaultMaterial != null) return pipeline.defaultMaterial;
                if (!standard) standard = new Material(Shader.Find("Standard"));
                return standard;
            }
        }

        /// <param name="material">Null: the default.</param>
        public static GameObject AddMesh(Transform parent, string name, Mesh mesh, Material material, Color color)
        {
            GameObject part = AddChild(parent, name);
            part.AddComponent<MeshFilter>().sharedMesh = mesh;
            var renderer = part.AddComponent<MeshRenderer>();
            renderer.sharedMaterial = material ? material : Default;
            var block = new MaterialPropertyBlock();
            block.SetColor("_Color", color);     // name in the built-in pipeline
            block.SetColor("_BaseColor", color); // name in URP and HDRP
            renderer.SetPropertyBlock(block);
            return part;
        }

        /// <summary>Destroys meshes: Unity keeps a mesh when its object is destroyed.</summary>
        public static void DestroyAll(List<Mesh> meshes)
        {
            foreach (Mesh mesh in meshes) Object.Destroy(mesh);
            meshes.Clear();
        }

        public static GameObject AddChild(Transform parent, string name)
        {
            var child = new GameObject(name);
            child.transform.SetParent(parent, false);
            child.layer = parent.gameObject.layer;
            return child;
        }

        /// <summary>The colour for #RRGGBB of a scene.</summary>
        public static Color ColorOf(string text)
        {
            Color color;
            return ColorUtility.TryParseHtmlString(text ?? "", out color) ? color : Color.gray;
        }

        /// <summary>A rigidbody for objects with colliders that are moved by script.</summary>
        public static Rigidbody AddKinematicRigidbody(GameObject to)
        {
            var rigidbody = to.AddComponent<Rigidbody>();
            rigidbody.isKinematic = true;
            rigidbody.useGravity = false;
            return rigidbody;
        }
    }
}
