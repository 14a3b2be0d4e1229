// SPDX-License-Identifier: Apache-2.0
// A pose in Unity's axes as a message for sonard (protocol/pose/pose.proto), without protobuf or the engine.
// SonardPublisher.cs uses it.
//
// Unity is left-handed: x right, y up, z forward, metres. The world's z is taken for north, so x is east.
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

    // Into sonard's axes: world x east, y north, z up; on board x forward, y to port, z up. Arguments are Unity's numbers.
    public static class FromUnity
    {
        public static Vector Position(double x, double y, double z) { return new Vector(x, z, y); }

        // From the vehicle's own axes (Transform.InverseTransformDirection), m/s.
        public static Vector Velocity(double x, double y, double z) { return new Vector(z, -x, y); }

        // From the vehicle's own axes, rad/s. The sense of a rotation is mirrored, so its signs are the other way round.
        public static Vector TurnRate(double x, double y, double z) { return new Vector(-z, x, -y); }

        // The rotation in mirrored axes, (w, -x, -z, -y), after a quarter turn on board: Unity's forward is y in these.
        public static Rotation Orientation(double x, double y, double z, double w)
        {
            double h = Math.Sqrt(0.5);
            return new Rotation(h * (w + y), h * (-x - z), h * (x - z), h * (w - y));
        }
    }

    // The message, in protobuf's encoding. Little-endian machines, as all that Unity runs on.
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

        // Something else that moves, by the name of its model in sonard's world.
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
