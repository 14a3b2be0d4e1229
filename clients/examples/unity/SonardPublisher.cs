// SPDX-License-Identifier: Apache-2.0
// A component for the vehicle that sends its pose to sonard after each step of the physics (50 per second by default).
// Copy it and SonardPose.cs into the Assets folder and drop it on the vehicle's game object.
using System.Net.Sockets;
using Sonard;
using UnityEngine;

public class SonardPublisher : MonoBehaviour
{
    public string host = "127.0.0.1";
    public int port = 14600;
    public Transform[] bodies = new Transform[0]; // other moving objects, named as in sonard's world

    UdpClient udp;
    Rigidbody body;

    public void Start()
    {
        udp = new UdpClient(host, port);
        body = GetComponent<Rigidbody>(); // without one, poses come with a velocity of 0
    }

    public void FixedUpdate()
    {
        Vector3 p = transform.position;
        Quaternion q = transform.rotation;
        Vector3 v = Vector3.zero, turn = Vector3.zero;
        if (body != null)
        {
            v = transform.InverseTransformDirection(body.GetPointVelocity(p));
            turn = transform.InverseTransformDirection(body.angularVelocity);
        }
        PoseMessage message = new PoseMessage(
            Time.fixedTimeAsDouble, FromUnity.Position(p.x, p.y, p.z), FromUnity.Orientation(q.x, q.y, q.z, q.w),
            FromUnity.Velocity(v.x, v.y, v.z), FromUnity.TurnRate(turn.x, turn.y, turn.z));
        foreach (Transform other in bodies)
        {
            p = other.position;
            q = other.rotation;
            message.AddBody(other.name, FromUnity.Position(p.x, p.y, p.z), FromUnity.Orientation(q.x, q.y, q.z, q.w));
        }
        byte[] datagram = message.ToArray();
        try
        {
            udp.Send(datagram, datagram.Length);
        }
        catch (SocketException)
        {
            // Nothing listens there yet; the next message is newer.
        }
    }

    public void OnDestroy()
    {
        if (udp != null)
        {
            udp.Close();
        }
    }
}
