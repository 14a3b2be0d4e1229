#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Answers of the page's server to monitors and viewers, on a machine of its own (a network namespace).

    web_test.py --programs DIR [TestCase.test_name ...]

Requests are written byte by byte, and the viewers use another implementation (python3-websockets).
"""

import argparse
import asyncio
import contextlib
import http.client
import json
import os
import re
import resource
import socket
import struct
import sys
import time
import unittest

import websockets

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "gemini"))
from lab import OwnMachine, Program  # noqa: E402

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
START_S = 60
PATIENCE_S = 30
PORT = 8014

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{{initial}udp: {{bind: 127.0.0.1:14600}}}}
sampling: {{preset: fast}}
web:
  bind: 127.0.0.1:{port}
  token: secret
{more}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network:
      alternate_address: 127.0.0.2
      netmask: 255.0.0.0
      status: [127.0.0.1]
"""


class Web(OwnMachine):
    def start(self, more="", initial="initial: {position_m: [0, 0, 0]}, "):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, port=PORT, more=more, initial=initial))
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def client(self, seconds):
        client = Program([os.path.join(PROGRAMS, "sonarview"), "--continuous", "60", "--range", "10", "--seconds",
                          str(seconds), "--out", self.folder.name], "sonarview")
        self.addCleanup(client.kill)
        client.wait_for_line("[1-9][0-9]* pings", START_S)
        return client

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", PORT, timeout=PATIENCE_S)
        self.addCleanup(connection.close)
        connection.request(method, path, body, headers or {})
        answer = connection.getresponse()
        return answer.status, answer.read().decode(), answer

    def test_monitors(self):
        daemon = self.start()
        self.assertRegex(daemon.output(), rf"web: http://127\.0\.0\.1:{PORT}\b")
        status, text, _ = self.ask("GET", "/health")
        self.assertEqual((status, json.loads(text)), (200, {"status": "ok"}))
        status, text, answer = self.ask("GET", "/metrics")
        self.assertEqual(status, 200)
        self.assertEqual(answer.getheader("Content-Type"), "text/plain; version=0.0.4; charset=utf-8")
        self.assertRegex(text, r'(?m)^sonard_pings_total\{head="bow"\} \d+$')
        status, text, _ = self.ask("GET", "/api/status")
        head = json.loads(text)["heads"][0]
        self.assertEqual((head["name"], head["type"], head["scanning"]), ("bow", "gemini_720i", False))
        status, text, _ = self.ask("GET", "/api/world")
        body = json.loads(text)["bodies"][0]
        self.assertEqual(body["name"], "sphere")
        # The box around a sphere of 0.5 m at (3, 2, 0).
        self.assertAlmostEqual(body["min_m"][0], 2.5, delta=0.01)
        self.assertAlmostEqual(body["max_m"][1], 2.5, delta=0.01)
        self.assertEqual(self.ask("HEAD", "/")[0], 200)
        self.assertEqual(self.ask("GET", "/nothing")[0], 404)
        self.assertEqual(self.ask("DELETE", "/api/status")[0], 405)
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    def send_pose(self):
        """The newest version of the message of protocol/pose/pose.proto, by posecast's own code."""
        path = os.path.join(self.folder.name, "way.csv")
        with open(path, "w", encoding="ascii") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n60,0,0,0,0,0,0,1\n")
        caster = Program([os.path.join(PROGRAMS, "posecast"), path], "posecast")
        self.addCleanup(caster.kill)

    def test_readiness_waits_for_a_pose_and_for_no_client(self):
        self.start(initial="")
        status, text, _ = self.ask("GET", "/ready")
        answer = json.loads(text)
        self.assertEqual((status, answer["ready"], answer["pose_known"], answer["pose_age_s"]), (503, False, False, None))
        self.assertEqual(answer["reasons"],
                         ["the vehicle has no pose: send poses to pose stream udp 127.0.0.1:14600"])
        self.assertEqual(self.ask("GET", "/health")[0], 200, "it is alive all the same")
        self.send_pose()
        end = time.monotonic() + PATIENCE_S
        while self.ask("GET", "/ready")[0] != 200:
            self.assertLess(time.monotonic(), end, "a pose made nobody ready")
            time.sleep(0.1)
        answer = json.loads(self.ask("GET", "/ready")[1])
        self.assertTrue(answer["pose_known"])
        self.assertLess(answer["pose_age_s"], PATIENCE_S)
        self.assertEqual(answer["reasons"], [])
        head = answer["heads"][0]
        self.assertEqual((head["name"], head["clients"], head["pings"], head["last_ping_age_s"]), ("bow", 0, 0, None))
        self.assertIn("127.0.0.2:52901", " ".join(head["serves"]))

    def test_a_late_viewer_gets_the_last_ping(self):
        self.start()
        client = self.client(600)
        client.terminate(PATIENCE_S)
        time.sleep(1)  # its last ping ages, and no other comes

        async def late(wanted):
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live", max_size=None) as live:
                await live.send(wanted)
                frame = await asyncio.wait_for(live.recv(), PATIENCE_S)
                header = json.loads(frame[4:4 + struct.unpack_from("<I", frame)[0]])
                await live.send(wanted)
                with self.assertRaises(asyncio.TimeoutError):
                    await asyncio.wait_for(live.recv(), 1)
                return header

        header = asyncio.run(late('{"type": "want", "head": 0, "max_rows": 500}'))
        # Pings count from 0; this is the last one, however many the machine made in time.
        self.assertEqual(header["number"] + 1, json.loads(self.ask("GET", "/api/status")[1])["heads"][0]["pings"])
        self.assertGreater(header["age_s"], 0.9)
        age_s = json.loads(self.ask("GET", "/ready")[1])["heads"][0]["last_ping_age_s"]
        self.assertGreater(age_s, header["age_s"])
        self.assertLess(age_s, header["age_s"] + PATIENCE_S)

    def test_other_sites_are_refused(self):
        self.start()
        self.assertEqual(self.ask("GET", "/api/status", headers={"Host": "evil.example"})[0], 403)
        self.assertEqual(self.ask("GET", "/api/status", headers={"Origin": "http://evil.example"})[0], 403)
        own = {"Origin": f"http://127.0.0.1:{PORT}"}
        self.assertEqual(self.ask("GET", "/api/status", headers=own)[0], 200)

        async def viewer(origin):
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live", origin=origin):
                return "open"

        self.assertEqual(asyncio.run(viewer(own["Origin"])), "open")
        with self.assertRaises(websockets.InvalidHandshake):
            asyncio.run(viewer("http://evil.example"))

    def test_recording_is_turned_off_and_on(self):
        logs = os.path.join(self.folder.name, "logs")
        daemon = self.start(f"recording: {{directory: {logs}, glf: false, pcapng: false}}")
        self.client(600)

        def mcaps():
            return [name for name in os.listdir(logs) if name.endswith(".mcap")]

        def until(what, holds):
            end = time.monotonic() + PATIENCE_S
            while not holds():
                self.assertLess(time.monotonic(), end, f"waited for: {what}; {daemon.tail()}")
                time.sleep(0.1)

        until("a log", lambda: len(mcaps()) == 1)
        self.assertEqual(self.ask("POST", "/api/recording", '{"on": false}')[:2], (200, '{"on":false}\n'))
        until("the log to be closed",
              lambda: json.loads(self.ask("GET", "/api/status")[1])["recording"]["logs_written"] == 1)
        time.sleep(1.5)  # names of logs have a resolution of a second, and pings go on
        self.assertEqual(len(mcaps()), 1)
        self.assertEqual(self.ask("POST", "/api/recording", '{"on": true}')[0], 200)
        until("a second log", lambda: len(mcaps()) == 2)
        self.assertEqual(self.ask("POST", "/api/recording", "nonsense")[0], 400)
        evil = {"Origin": "http://evil.example"}
        self.assertEqual(self.ask("POST", "/api/recording", '{"on": false}', evil)[0], 403)
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    def test_nothing_can_be_recorded_without_a_folder(self):
        self.start()
        self.assertEqual(self.ask("POST", "/api/recording", '{"on": true}')[0], 409)

    def test_bad_requests_harm_nobody(self):
        self.start()
        for request in (b"\0" * 100, b"GET / HTTP/1.1\r\nHost: " + b"a" * 20000, b"GET\r\n\r\n",
                        b"POST /api/recording HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 99999999\r\n\r\n"):
            with socket.create_connection(("127.0.0.1", PORT), timeout=PATIENCE_S) as raw:
                with contextlib.suppress(OSError):  # the server may hang up at any point
                    raw.sendall(request)
                    raw.shutdown(socket.SHUT_WR)
                    raw.recv(4096)

        async def talk():
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live") as live:
                for text in ("nonsense", "[]", '{"type": 7}', '{"type": "want", "head": -1, "max_rows": 9}',
                             '{"type": "want", "head": 99999999999999999999, "max_rows": 9}'):
                    await live.send(text)
                    self.assertEqual(json.loads(await asyncio.wait_for(live.recv(), PATIENCE_S))["type"], "error")
                await live.send("x" * 5000)  # longer than any message: the connection ends
                with self.assertRaises(websockets.ConnectionClosed):
                    await asyncio.wait_for(live.recv(), PATIENCE_S)

        asyncio.run(talk())
        self.assertEqual(self.ask("GET", "/health")[0], 200)

    def raw_answer(self, request):
        """The first line of the answer to these bytes, even if the server has not read all of them."""
        with socket.create_connection(("127.0.0.1", PORT), timeout=PATIENCE_S) as raw:
            raw.sendall(request)
            answer = b""
            while b"\r\n" not in answer:
                more = raw.recv(4096)
                if not more:
                    break
                answer += more
            return answer.split(b"\r\n")[0].decode()

    def test_requests_that_cannot_be_read_are_answered(self):
        self.start()
        host = b"Host: 127.0.0.1\r\n"
        for status, request in ((400, b"\0" * 100), (400, b"GET\r\n\r\n"), (400, b"\x16\x03\x01\x02\x00 this is TLS\r\n\r\n"),
                                (400, b"GET / HTTP/1.1\r\nno colon\r\n\r\n"),
                                (431, b"GET / HTTP/1.1\r\n" + host + b"X: " + b"a" * 100_000),
                                (413, b"POST /api/recording HTTP/1.1\r\n" + host + b"Content-Length: 99999999\r\n\r\n"),
                                (413, b"POST /api/recording HTTP/1.1\r\n" + host + b"Content-Length: 5000\r\n\r\n" + b"a" * 5000)):
            with self.subTest(request=request[:60]):
                self.assertTrue(self.raw_answer(request).startswith(f"HTTP/1.1 {status} "), self.raw_answer(request))
        self.assertEqual(self.ask("GET", "/health")[0], 200)

    def test_deeply_nested_json_ends_nothing(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_STACK)
        resource.setrlimit(resource.RLIMIT_STACK, (2 << 20, hard))  # as in small containers
        try:
            self.start()
        finally:
            resource.setrlimit(resource.RLIMIT_STACK, (soft, hard))
        deep = "[" * 32_000 + "]" * 32_000

        async def talk():
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/", subprotocols=["foxglove.websocket.v1"]) as viewer:
                await viewer.send('{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": ' + deep + "}]}")
                while True:
                    message = await asyncio.wait_for(viewer.recv(), PATIENCE_S)
                    if isinstance(message, str) and json.loads(message)["op"] == "status":
                        return

        asyncio.run(talk())
        self.assertEqual(self.ask("GET", "/health")[0], 200)

    def test_twenty_viewers_and_one_that_never_reads(self):
        daemon = self.start()
        client = self.client(600)

        def memory_kib():
            with open(f"/proc/{daemon.pid}/status", encoding="ascii") as file:
                return int(re.search(r"VmRSS:\s+(\d+)", file.read())[1])

        async def viewer(seen, index, seconds):
            end = time.monotonic() + seconds
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live", max_size=None) as live:
                while time.monotonic() < end:
                    await live.send('{"type": "want", "head": 0, "max_rows": 500}')
                    frame = await asyncio.wait_for(live.recv(), PATIENCE_S)
                    size = struct.unpack_from("<I", frame)[0]
                    header = json.loads(frame[4:4 + size])
                    self.assertEqual(len(frame), 4 + size + 4 * header["beams"] + header["beams"] * header["rows"])
                    self.assertLessEqual(header["rows"], 500)
                    seen[index] = header["number"]

        async def deaf(seconds):
            """Requests a thousand pings and reads none."""
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live", max_queue=1, close_timeout=0.1) as live:
                for _ in range(1000):
                    await live.send('{"type": "want", "head": 0, "max_rows": 4000}')
                    await asyncio.sleep(seconds / 1000)

        async def all_of_them(seen, seconds):
            await asyncio.gather(deaf(seconds), *(viewer(seen, i, seconds) for i in range(20)))

        seen = {}
        asyncio.run(all_of_them(seen, 3))
        before_kib = memory_kib()
        asyncio.run(all_of_them(seen, 10))
        self.assertEqual(len(seen), 20)
        self.assertLess(memory_kib() - before_kib, 20_000)
        client.terminate(PATIENCE_S)
        self.assertRegex(client.output(), r"summary pings_complete=[1-9].* lines_missing=0 ")

    def test_health_beside_128_idle_sockets_and_twenty_viewers(self):
        """Two peers take all places for viewers, and one of them also requests pings and pictures."""
        self.start()
        self.client(600)

        async def idle(peer):
            return await websockets.connect(f"ws://127.0.0.1:{PORT}/api/live", local_addr=(peer, 0))

        async def live():
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live", max_size=None) as viewer:
                while True:
                    await viewer.send('{"type": "want", "head": 0, "max_rows": 500}')
                    await viewer.recv()

        async def foxglove():
            async with websockets.connect(f"ws://127.0.0.1:{PORT}", max_size=None,
                                          subprotocols=["foxglove.websocket.v1"]) as viewer:
                await viewer.send('{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}]}')
                while True:
                    await viewer.recv()

        def health_s():
            began = time.monotonic()
            for path in ("/health", "/metrics", "/ready"):
                self.assertEqual(self.ask("GET", path)[0], 200, path)
            return time.monotonic() - began

        async def all_of_them():
            viewers = [asyncio.create_task(viewer()) for viewer in (live, foxglove) for _ in range(10)]
            await asyncio.sleep(1)
            kept = [await idle("127.0.0.1") for _ in range(44)] + [await idle("127.0.0.3") for _ in range(64)]
            for peer in ("127.0.0.1", "127.0.0.3", "127.0.0.4"):
                with self.assertRaises(websockets.InvalidStatusCode) as refused:
                    await idle(peer)
                self.assertEqual(refused.exception.status_code, 503)
            took = [await asyncio.to_thread(health_s) for _ in range(20)]
            self.assertFalse([viewer for viewer in viewers if viewer.done()], "a viewer was closed")
            for viewer in viewers:
                viewer.cancel()
            for socket_ in kept:
                socket_.transport.abort()
            return took

        took = sorted(asyncio.run(all_of_them()))
        print(f"/health, /metrics and /ready beside 128 viewers: median {took[10]:.3f} s, most {took[-1]:.3f} s")
        self.assertLess(took[-1], 5.0, "promised: 0.1 s each, on a machine that has nothing else to do")

    def test_connections_that_are_silent_make_room_for_a_monitor(self):
        self.start()
        kept = [socket.create_connection(("127.0.0.1", PORT), timeout=PATIENCE_S) for _ in range(300)]
        self.addCleanup(lambda: [connection.close() for connection in kept])
        self.assertEqual(self.ask("GET", "/health")[0], 200)

    def test_sockets_that_are_silent_or_never_read_are_closed(self):
        daemon = self.start()
        self.client(600)

        def shake_hands(path):
            raw = socket.create_connection(("127.0.0.1", PORT), timeout=PATIENCE_S)
            self.addCleanup(raw.close)
            raw.sendall((f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n").encode())
            answer = b""
            while b"\r\n\r\n" not in answer:
                answer += raw.recv(1)
            self.assertIn(b" 101 ", answer)
            return raw

        def ended(raw):
            try:
                raw.setblocking(False)
                while raw.recv(65536):
                    pass
                return True
            except BlockingIOError:
                return False
            except OSError:
                return True

        unread = shake_hands("/api/live")
        silent = [socket.create_connection(("127.0.0.1", PORT), timeout=PATIENCE_S), shake_hands("/api/live")]
        self.addCleanup(silent[0].close)
        text = b'{"type": "want", "head": 0, "max_rows": 4000}'
        frame = bytes([0x81, 0x80 | len(text)]) + bytes(4) + text  # masked with zeros
        end = time.monotonic() + 2 * PATIENCE_S
        while True:  # it only sends, and what it is sent fills all buffers
            try:
                unread.sendall(frame)
            except OSError:
                break
            self.assertLess(time.monotonic(), end, "a viewer that never reads is kept")
            time.sleep(0.02)
        self.assertRegex(daemon.output(), r"web: 127\.0\.0\.1:\d+ refused: the viewer reads too slowly")
        while not all(ended(raw) for raw in silent):
            self.assertLess(time.monotonic(), end, "a silent connection is kept")
            time.sleep(0.2)

    def test_sigterm_does_not_wait_for_sixty_viewers(self):
        """Viewers of pictures for Foxglove; half of them never read."""
        daemon = self.start()
        self.client(600)

        news = asyncio.Event()

        async def viewer(reads):
            peer = await websockets.connect(f"ws://127.0.0.1:{PORT}", max_size=None, max_queue=1,
                                              subprotocols=["foxglove.websocket.v1"], close_timeout=0.1)
            channels = []
            while not channels:
                message = json.loads(await asyncio.wait_for(peer.recv(), PATIENCE_S))
                channels = [channel["id"] for channel in message.get("channels", [])
                            if channel["topic"].endswith("/image")]
            await peer.send(json.dumps({"op": "subscribe", "subscriptions":
                                          [{"id": channel, "channelId": channel} for channel in channels]}))
            if reads:
                await asyncio.wait_for(peer.recv(), PATIENCE_S)

            async def read_on():
                with contextlib.suppress(websockets.ConnectionClosed):
                    while reads:
                        await peer.recv()
                        news.set()
            return peer, asyncio.create_task(read_on())

        async def all_of_them():
            kept = [await viewer(reads=i % 2 == 0) for i in range(60)]
            await asyncio.sleep(3)
            news.clear()
            await asyncio.wait_for(news.wait(), PATIENCE_S)  # the first of 60 has a picture
            took = await asyncio.to_thread(daemon.terminate, PATIENCE_S)
            for peer, task in kept:
                task.cancel()
                peer.transport.abort()
            return took

        code, took_s = asyncio.run(all_of_them())
        print(f"SIGTERM with 60 viewers: {took_s:.2f} s")
        self.assertEqual(code, 0)
        self.assertLess(took_s, 5.0, "promised: 1 s, on a machine that has nothing else to do")

    def test_a_hidden_viewer_gets_nothing(self):
        self.start()
        self.client(600)

        async def hidden():
            async with websockets.connect(f"ws://127.0.0.1:{PORT}/api/live") as live:
                with self.assertRaises(asyncio.TimeoutError):
                    await asyncio.wait_for(live.recv(), 2)

        asyncio.run(hidden())


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard and sonarview")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
