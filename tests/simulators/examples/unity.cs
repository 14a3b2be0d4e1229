// SPDX-License-Identifier: Apache-2.0
// Stands in for Unity: metres, x right, y up, z forward; angles of Quaternion.Euler, applied in the order z, x, y; velocities
// in the world's axes. The few types of the engine that SonardPublisher.cs takes, and a scene with one vehicle.
//   mono unity.exe PORT COUNT X Y Z EX EY EZ VX VY VZ WX WY WZ [X Y Z EX EY EZ]      COUNT 0: until it is ended
// The last six are position and angles of the body "walls".
using System;
using System.Diagnostics;
using System.Globalization;
using System.Threading;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;
        public static readonly Vector3 zero = new Vector3();
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    }

    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }

        public static Quaternion operator *(Quaternion a, Quaternion b)
        {
            return new Quaternion(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                                  a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
        }

        // A positive angle takes x to y, y to z, z to x: about y, from forward to the right.
        static Quaternion About(float x, float y, float z, float degrees)
        {
            double half = degrees * Math.PI / 360;
            float s = (float)Math.Sin(half);
            return new Quaternion(s * x, s * y, s * z, (float)Math.Cos(half));
        }

        public static Quaternion Euler(float x, float y, float z)
        {
            return About(0, 1, 0, y) * About(1, 0, 0, x) * About(0, 0, 1, z);
        }
    }

    public class Transform
    {
        public string name;
        public Vector3 position;
        public Quaternion rotation;

        public Vector3 InverseTransformDirection(Vector3 v)
        {
            Quaternion inverse = new Quaternion(-rotation.x, -rotation.y, -rotation.z, rotation.w);
            Quaternion turned = inverse * new Quaternion(v.x, v.y, v.z, 0) * rotation;
            return new Vector3(turned.x, turned.y, turned.z);
        }
    }

    public class Rigidbody
    {
        public Vector3 velocity, angularVelocity;
        // The centre of mass is the origin here.
        public Vector3 GetPointVelocity(Vector3 worldPoint) { return velocity; }
    }

    public class MonoBehaviour
    {
        public Transform transform = new Transform();
        public Rigidbody rigidbodyComponent = new Rigidbody();
        public T GetComponent<T>() where T : class { return rigidbodyComponent as T; }
    }

    public static class Time
    {
        public static double fixedTimeAsDouble { get { return (double)Stopwatch.GetTimestamp() / Stopwatch.Frequency; } }
    }
}

public static class Scene
{
    public static void Main(string[] arguments)
    {
        float[] n = Array.ConvertAll(arguments, text => float.Parse(text, CultureInfo.InvariantCulture));
        SonardPublisher vehicle = new SonardPublisher { port = (int)n[0] };
        vehicle.transform.position = new UnityEngine.Vector3(n[2], n[3], n[4]);
        vehicle.transform.rotation = UnityEngine.Quaternion.Euler(n[5], n[6], n[7]);
        vehicle.rigidbodyComponent.velocity = new UnityEngine.Vector3(n[8], n[9], n[10]);
        vehicle.rigidbodyComponent.angularVelocity = new UnityEngine.Vector3(n[11], n[12], n[13]);
        if (n.Length == 20)
        {
            vehicle.bodies = new[] { new UnityEngine.Transform { name = "walls", position = new UnityEngine.Vector3(n[14], n[15], n[16]),
                                                                 rotation = UnityEngine.Quaternion.Euler(n[17], n[18], n[19]) } };
        }
        vehicle.Start();
        for (int i = 0; n[1] == 0 || i < n[1]; i++)
        {
            vehicle.FixedUpdate();
            Thread.Sleep(20);
        }
        vehicle.OnDestroy();
    }
}
