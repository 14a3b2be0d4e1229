// SPDX-License-Identifier: Apache-2.0
// Converts a pose in Unity's axes to a message for sonard (protocol/pose/pose.proto), without protobuf or the engine.
// SonardPublisher.cs uses it.
//
// Unity is left-handed: x right, y up, z forward, metres. The world's z is sent as north, so x is east.
using System;
using System.IO;
using System.Text;

namespace Sonard
{
    public struct Vector
    {
        public double X, Y, Z;
        public Vector(double x, double y, double z) { X = x; Y = y; Z = z; }
    }

    public struct Rotation
    {
        public double W, X, Y, Z;
        public Rotation(double w, double x, double y, double z) { W = w; X = x; Y = y; Z = z; }
    }

    // Converts Unity's numbers to sonard's axes: world x east, y north, z up; vehicle x forward, y to port, z up.
    public static class FromUnity
    {
        public static Vector Position(double x, double y, double z) { return new Vector(x, z, y); }

        // In the vehicle's axes (Transform.InverseTransformDirection), m/s.
        public static Vector Velocity(double x, double y, double z) { return new Vector(z, -x, y); }

        // In the vehicle's axes, rad/s. Mirroring also reverses rotations, so the signs are opposite to Velocity().
        public static Vector TurnRate(double x, double y, double z) { return new Vector(-z, x, -y); }

        // The rotation in mirrored axes, (w, -x, -z, -y), times a quarter turn, because Unity's forward axis is y there.
        public static Rotation Orientation(double x, double y, double z, double w)
        {
            double h = Math.Sqrt(0.5);
            return new Rotation(h * (w + y), h * (-x - z), h * (x - z), h * (w - y));
        }
    }

    // The message, in protobuf's encoding. Requires a little-endian machine; Unity runs on no other.
    public class PoseMessage
    {
        readonly MemoryStream bytes = new MemoryStream();

        public PoseMessage(double seconds, Vector position, Rotation orientation, Vector velocity, Vector turnRate)
        {
            Varint(1 << 3); // time_ns
            Varint((ulong)(seconds * 1e9));
            Part(3, PoseOf(position, orientation));
            PoseMessage twist = new PoseMessage();
            twist.Part(1, Doubles(velocity.X, velocity.Y, velocity.Z));
            twist.Part(2, Doubles(turnRate.X, turnRate.Y, turnRate.Z));
            Part(4, twist);
        }

        // Another moving object, by the name of its model in sonard's world.
        public void AddBody(string name, Vector position, Rotation orientation)
        {
            PoseMessage body = new PoseMessage();
            byte[] utf8 = Encoding.UTF8.GetBytes(name);
            body.Varint(1 << 3 | 2);
            body.Varint((ulong)utf8.Length);
            body.bytes.Write(utf8, 0, utf8.Length);
            body.Part(2, PoseOf(position, orientation));
            Part(5, body);
        }

        public byte[] ToArray() { return bytes.ToArray(); }

        PoseMessage() { }

        static PoseMessage PoseOf(Vector p, Rotation q)
        {
            PoseMessage pose = new PoseMessage();
            pose.Part(1, Doubles(p.X, p.Y, p.Z));
            pose.Part(2, Doubles(q.W, q.X, q.Y, q.Z));
            return pose;
        }

        static PoseMessage Doubles(params double[] values)
        {
            PoseMessage message = new PoseMessage();
            for (int i = 0; i < values.Length; i++)
            {
                message.Varint((ulong)((i + 1) << 3 | 1));
                message.bytes.Write(BitConverter.GetBytes(values[i]), 0, 8);
            }
            return message;
        }

        void Part(int field, PoseMessage part)
        {
            Varint((ulong)(field << 3 | 2));
            Varint((ulong)part.bytes.Length);
            part.bytes.WriteTo(bytes);
        }

        void Varint(ulong value)
        {
            for (; value >= 0x80; value >>= 7)
            {
                bytes.WriteByte((byte)(value | 0x80));
            }
            bytes.WriteByte((byte)value);
        }
    }
}
