#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the fuzzing seeds in corpus/ from the byte examples in tests/data, and logs made here.

gemini/datagrams/  one example each, as it is
gemini/device/     scripts for fuzz_gemini_device: what a client sends to a head, with time between
gemini/client/    scripts for fuzz_gemini_client: what a head sends to a client
micron/frames/     one example each, and streams of some
micron/device/     scripts for fuzz_micron_device: what a client sends to a head
micron/client/       scripts for fuzz_micron_client: what a head sends to a client
oculus/device/     scripts for fuzz_oculus_device: what clients send to a head
oculus/client/       streams of a head
ping360/           the same three for the Ping360
sonar3d15/packets/ recordings, messages and blocks of Snappy
sonar3d15/device/  scripts for fuzz_sonar3d15_device: requests of clients, and images
dvl_a50/stream/    texts of both directions of a DVL
dvl_a50/device/    scripts for fuzz_dvl_a50_device: what clients send to a device
glf/log/           small logs, bare and in every kind of archive
mcap/, pcapng/     small files, whole and cut
mavlink/           datagrams of each message, signed, among others, broken
pose/              pose messages, and streams of them
configuration/     configurations that are good, and those with one mistake each
sdf/               small worlds
ply/               text and binary of both byte orders, whole and cut
stl/               text and binary, whole and cut
web/               what a browser sends over one connection
web_messages/      JSON messages of a viewer, a line each, for the protocol of the first byte

The form of a script is described in script.hpp. Run it again after adding an example; files that are there
for another reason (inputs that once failed) are left alone.
"""
import io
import pathlib
import struct
import sys
import zipfile
import zlib

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "data"
CORPUS = HERE / "corpus"
CONFIGURATIONS = HERE.parent.parent / "configs"
sys.path += [str(HERE.parent / "system" / "gemini"), str(HERE.parent / "support")]
import wire
from example_messages import example, messages

# Kinds of events, as in the programs for the Gemini.
FROM_A, FROM_B, FEED, TRIGGER, WATER, IMAGE, IMAGE_FAILED, NEXT_DUE = range(8)
FROM_HEAD, START_SINGLE, START_CONTINUOUS, STOP, PAUSE = 0, 4, 5, 6, 7
# And for the Micron.
BYTES, LINE_FED, HOST_GONE, POWER_CYCLE, LOSE_STEP, LINE, LINE_FAILED, LINE_NEXT_DUE = range(8)
START_8_BIT, START_4_BIT, STOP_SCAN, GAIN, REVERSE = range(1, 6)
# And for the Ping360: bytes of three clients, then these.
P360_A, P360_B, P360_SERIAL, P360_GONE, P360_IMAGE, P360_FAILED, P360_FEED, P360_NEXT_DUE = range(8)
P360_BYTES, P360_TURN, P360_SCAN, P360_STOP = range(4)
PLAYS_BACK, WAITS, FAN_OUT, UNSCALED, SPLITS, SIGNED, CLAMPS, TWO_CLIENTS = (1 << bit for bit in range(8))
# And for the Oculus: bytes of two clients, then these.
OCULUS, OCULUS_OTHER, OCULUS_CLIENT, OCULUS_SECOND, OCULUS_IMAGE, OCULUS_FAILED, OCULUS_FEED, OCULUS_NEXT_DUE = range(8)
AS_IS = 0x80


def gemini(name):
    return example("gemini", name)


def event(kind, datagram=None, delay=2):
    """delay squared times 0.1 ms pass before the event."""
    head = bytes([kind, delay])
    return head if datagram is None else head + struct.pack("<H", len(datagram)) + datagram


def patched(name, offset, form, value):
    data = bytearray(gemini(name))
    struct.pack_into(form, data, offset, value)
    return bytes(data)


def pings_of_40_lines(continuous):
    data = bytearray(patched("ping_config", 22, "<H", 40))
    struct.pack_into("<H", data, 16, int(continuous))
    return bytes(data)


def device_scripts():
    """Of a head that renders, then of one that plays a recording back or follows simulated time."""
    for name, script in rendering_device_scripts():
        yield name, b"\0" + script
    continuous = pings_of_40_lines(continuous=True)
    start = event(FROM_A, continuous)

    def fed(lines=40, flags=0, step_m=0.05, speed_mps=1500.0, gain_percent=50.0):
        return event(FEED, struct.pack("<BHddd", flags, lines, step_m, speed_mps, gain_percent)) + event(IMAGE) + event(
            PAUSE, delay=40)

    yield "played", bytes([PLAYS_BACK]) + start + fed() + fed(flags=2) + fed(lines=300, step_m=0.1, gain_percent=-1.0)
    yield "played_two_clients", bytes([PLAYS_BACK | 4]) + start + fed() + event(FROM_B, continuous) + fed()
    yield "not_played", bytes([PLAYS_BACK]) + start + fed(lines=0) + fed(flags=1) + fed(lines=65535) + fed(step_m=1e-300)
    yield "next_ping_due", bytes([WAITS]) + start + 3 * (event(NEXT_DUE, delay=40) + event(IMAGE))


def rendering_device_scripts():
    single, continuous = pings_of_40_lines(continuous=False), pings_of_40_lines(continuous=True)
    ping = event(FROM_A, single) + event(IMAGE) + event(PAUSE, delay=20)
    yield "single_ping", event(FROM_A, gemini("status_request")) + ping
    yield "retries", ping + b"".join(
        event(FROM_A, patched(name, 10, "<H", 5)) for name in ("retry_line", "retry_tail", "observed_retry_lines"))
    yield "continuous", event(FROM_A, continuous) + 4 * (event(IMAGE) + event(PAUSE, delay=40))
    yield "silence_and_resume", event(FROM_A, continuous) + event(IMAGE) + event(PAUSE, delay=200) + event(
        FROM_A, gemini("status_request")) + event(IMAGE)
    yield "run_length", event(FROM_A, single[:54] + b"\x32\x00" + single[56:]) + event(IMAGE) + event(PAUSE)
    yield "sixteen_bit", event(FROM_A, single[:18] + b"\x00\x02" + single[20:]) + event(IMAGE) + event(PAUSE)
    yield "compressed", event(FROM_A, single[:52] + b"\x02\x00" + single[54:]) + event(IMAGE) + event(PAUSE)
    yield "trigger", event(FROM_A, single[:16] + b"\x02\x00" + single[18:]) + event(TRIGGER) + event(IMAGE)
    yield "out_of_water", event(WATER) + event(FROM_A, single[:18] + b"\x04\x00" + single[20:]) + event(WATER) + ping
    yield "failed_image", event(FROM_A, single) + event(IMAGE_FAILED) + ping
    yield "two_clients", ping + event(FROM_B, single) + event(IMAGE) + event(FROM_A, gemini("status_request"))
    yield "reboot", event(FROM_A, gemini("observed_info_block_write")) + event(FROM_A, gemini("observed_reboot")) + event(
        PAUSE, delay=250) + ping
    yield "session", b"".join(
        event(FROM_A, gemini(name), delay=5)
        for name in ("mdio_commands", "status_request", "observed_diagnostic_request", "network_config")
    ) + ping + event(FROM_A, gemini("observed_going_offline"))
    yield "production", b"".join(
        event(FROM_A, gemini(name)) for name in (
            "flash_read", "info_block_read", "info_block_write_identity", "serial_transmit", "test_result_request",
            "production_test", "power_on_self_test", "abort_production_test", "tx_drive_test", "gpo_write", "gpio_read"))
    yield "flash_write", event(FROM_A, gemini("flash_write")) + event(FROM_A, gemini("flash_read"))


def ping_datagrams(lines, resent=()):
    """Head, lines and tail of a ping; the lines of `resent` come after the tail."""
    line = gemini("ping_line")

    def numbered(number, flag=0):
        info = 0x2044 if number == lines - 1 else 0x2004
        return line[:10] + struct.pack("<HHH", number | flag, 0x1E00, info) + line[16:]

    yield patched("ping_head", 22, "<H", lines)
    for number in range(lines):
        if number not in resent:
            yield numbered(number)
    yield gemini("ping_tail")
    for number in resent:
        yield numbered(number, 0x8000)
    if resent:
        yield gemini("ping_tail_resent")


def client_scripts():
    meet = event(FROM_HEAD, gemini("status")) + event(FROM_HEAD, gemini("status"))

    def ping(*args, **kwargs):
        return b"".join(event(FROM_HEAD, d, delay=1) for d in ping_datagrams(*args, **kwargs))

    yield "single_ping", meet + event(START_SINGLE) + ping(4)
    yield "continuous", meet + event(START_CONTINUOUS) + ping(3)
    yield "repaired", meet + event(START_SINGLE) + ping(6, resent=(2, 3))
    yield "lost_tail", meet + event(START_SINGLE) + b"".join(
        event(FROM_HEAD, d, delay=1) for d in list(ping_datagrams(4))[:-1]) + event(PAUSE, delay=150)
    yield "lost_head", meet + event(START_SINGLE) + b"".join(
        event(FROM_HEAD, d, delay=1) for d in list(ping_datagrams(3))[1:]) + event(PAUSE, delay=150)
    yield "no_answer", meet + event(START_SINGLE) + event(PAUSE, delay=200) + event(STOP)
    yield "small_talk", meet + event(FROM_HEAD, gemini("acknowledge")) + event(
        FROM_HEAD, gemini("diagnostic")) + event(FROM_HEAD, gemini("gpi_data"))


def micron_frame(name, as_is=False, delay=2):
    """A frame as it is, or its type and data, of which the program makes a frame again."""
    frame = example("micron", name)
    return event(AS_IS | BYTES, frame, delay) if as_is else event(BYTES, frame[10:11] + frame[13:-1], delay)


def micron_device_scripts():
    """Of a head that renders, then of one that plays a recording back or follows simulated time."""
    for name, script in rendering_micron_device_scripts():
        yield name, b"\0" + script
    scan = event(PAUSE, delay=220) + micron_frame("head_command_ros", as_is=True) + micron_frame("send_data") + event(
        PAUSE, delay=100)
    whole = example("micron", "head_data")
    outline = whole[13:42] + struct.pack("<H", 0)
    line = event(LINE) + event(PAUSE, delay=30)
    yield "played", bytes([PLAYS_BACK]) + scan + 3 * (event(LINE_FED, outline) + line + micron_frame("send_data"))
    yield "not_played", bytes([PLAYS_BACK]) + scan + event(AS_IS | LINE_FED, whole) + line + event(LINE_FED, b"\xff") + line
    yield "next_ping_due", bytes([WAITS]) + scan + 3 * (event(LINE_NEXT_DUE, delay=40) + line)


def rendering_micron_device_scripts():
    up = event(PAUSE, delay=220)
    line = event(LINE) + event(PAUSE, delay=30)
    for driver in ("ros", "rock", "uxv", "gain_block"):
        yield f"scan_{driver}", up + micron_frame(f"head_command_{driver}") + micron_frame("send_data") + event(
            PAUSE, delay=100) + 2 * line
    scan = up + micron_frame("head_command_ros", as_is=True) + micron_frame("send_data") + event(PAUSE, delay=60)
    yield "connect", up + micron_frame("send_version", as_is=True) + micron_frame("send_bb_user") + micron_frame(
        "send_fpga_version") + micron_frame("send_fpga_cal_data") + event(PAUSE, delay=110)
    yield "gain_and_reverse", scan + line + micron_frame("gain") + micron_frame("reverse") + line
    yield "new_parameters", scan + micron_frame("head_command_uxv") + event(LINE) + event(PAUSE, delay=100) + 2 * line
    yield "reboot", scan + micron_frame("reboot") + event(LINE_FAILED) + up + micron_frame("send_data_with_time")
    yield "faults", scan + event(LOSE_STEP) + line + event(POWER_CYCLE) + up + event(HOST_GONE)
    yield "no_alives", micron_frame("stop_alives", delay=110) + up
    cut = bytes.fromhex("40 30 30 30 43 0c 00 ff 02 07 10 80 02 0a")
    yield "cut_reboot", up + event(AS_IS | BYTES, cut) + event(PAUSE, delay=35) + up
    whole = example("micron", "head_command_uxv")
    yield "split", up + event(AS_IS | BYTES, whole[:20]) + event(AS_IS | BYTES, whole[20:]) + micron_frame("send_data")


def micron_client_scripts():
    def meet(start):
        return micron_frame("alive_5d", as_is=True) + micron_frame("version_data") + micron_frame(
            "bb_user_data") + event(start) + micron_frame("alive_ca")

    yield "scan", meet(START_8_BIT) + 3 * micron_frame("head_data", delay=20)
    yield "scan_4_bit", meet(START_4_BIT) + 3 * micron_frame("head_data_4_bit", delay=20)
    yield "timeouts", meet(START_8_BIT) + event(PAUSE, delay=250) + micron_frame("alive_8a")
    yield "rebooted_head", meet(START_8_BIT) + micron_frame("alive_5d") + micron_frame("alive_ca")
    yield "changes", meet(START_8_BIT) + event(GAIN) + event(REVERSE) + micron_frame("head_data") + event(STOP_SCAN)
    yield "silent_head", event(START_8_BIT) + event(PAUSE, delay=250)
    yield "small_talk", micron_frame("fpga_cal_data") + micron_frame("fpga_version_data") + micron_frame("aux_data")


def oculus_device_scripts():
    def script(flags, *events):
        return bytes([flags]) + event(OCULUS_CLIENT) + b"".join(events)

    def fire(name, delay=2):
        return event(AS_IS | OCULUS, example("oculus", name), delay)

    image = event(OCULUS_IMAGE, delay=32)
    for name in ("vendor", "ensta", "ensta_resume_v2", "liboculus_8_bit", "liboculus_32_bit"):
        yield name, script(0, 2 * (fire(f"fire_{name}") + image), event(OCULUS_IMAGE, delay=100))
    yield "standby", script(4, fire("fire_ensta"), image, fire("fire_ensta_standby"), event(OCULUS_FAILED, delay=200),
                            fire("fire_ensta"), image)
    yield "user_config", script(0, fire("user_config_request"), fire("user_config"), fire("fire_vendor"), image)
    yield "second_client", script(8, fire("fire_ensta"), event(OCULUS_SECOND), event(OCULUS_OTHER, b"", 10), image,
                                  event(OCULUS_CLIENT), event(OCULUS_CLIENT), fire("fire_vendor"), image)
    whole = example("oculus", "fire_liboculus_8_bit")
    yield "split", script(0, event(AS_IS | OCULUS, b"SxS" + whole[:30]), event(AS_IS | OCULUS, whole[30:]), image)
    yield "too_long", script(0, event(AS_IS | OCULUS, whole[:10] + b"\0\0\1\0" + whole[14:]), fire("fire_vendor"))
    yield "next_ping_due", script(PLAYS_BACK << 1, fire("fire_ensta"), 3 * (event(OCULUS_NEXT_DUE) + image))
    yield "played", script(PLAYS_BACK, fire("fire_liboculus_32_bit"), 3 * (event(OCULUS_FEED) + image))
    body = example("oculus", "fire_ensta")[16:]
    yield "bodies", script(0x10, event(OCULUS, body), image, event(OCULUS, b"\1\2\1\0\xff" + body[5:]), image)


def oculus_streams():
    names = ("ping_result_v1", "ping_result_v2", "dummy", "user_config")
    for name in names:
        yield name, example("oculus", name)
    yield "stream", b"S\0SO".join(example("oculus", name) for name in names)
    yield "log", example("oculus", "dummy")[:6] + b"\x80\0\0\0\5\0\0\0\0\0ready"


def ping360_message(name, kind=P360_A, as_is=False, delay=2):
    """A frame as it is, or its number and payload, of which the program makes a frame again."""
    frame = example("ping360", name)
    return event(AS_IS | kind, frame, delay) if as_is else event(kind, frame[4:6] + frame[8:-2], delay)


def ping360_device_scripts():
    def script(flags, *events):
        return bytes([flags]) + b"".join(events)

    image = event(P360_IMAGE, delay=20)
    scan = ping360_message("auto_transmit", as_is=True)
    ping = ping360_message("transducer", delay=4) + event(P360_IMAGE, delay=130)
    for client in ("brping", "ros_python", "pnarvor"):
        yield client, script(0, ping360_message("request_protocol_version"), ping360_message("request_device_data"),
                             2 * (ping360_message(f"transducer_{client}") + event(P360_IMAGE, delay=130)),
                             ping360_message("motor_off"))
    yield "scan", script(0, scan, 4 * image, ping360_message("request_device_data"), ping360_message("motor_off"))
    yield "scan_ends", script(0, scan, image, event(AS_IS | P360_B, b""), scan, ping, scan, image, ping360_message("reset"))
    yield "serial", script(0, event(AS_IS | P360_SERIAL, b"UUUUUUUUUU\0"), ping360_message("auto_transmit", P360_SERIAL),
                           image, event(AS_IS | P360_SERIAL, b"U"))
    yield "sector", script(SIGNED | CLAMPS, event(P360_A, struct.pack("<HBBHHHHHHBB", 2602, 1, 2, 32, 80, 740, 200, 65336, 10, 7, 3)),
                           6 * image)
    yield "two_clients", script(FAN_OUT | TWO_CLIENTS, scan, ping360_message("request_device_information", P360_B), image,
                                event(P360_GONE), ping360_message("motor_off", P360_SERIAL))
    yield "cancelled", script(UNSCALED, scan, ping360_message("motor_off"), event(P360_FAILED), scan, event(P360_FAILED))
    yield "next_ping_due", script(WAITS, scan, 3 * (event(P360_NEXT_DUE) + image))
    yield "played", script(PLAYS_BACK | SPLITS, scan, 3 * (event(P360_FEED) + image), ping360_message("transducer"),
                           event(P360_FEED), image)
    yield "ids", script(0, ping360_message("set_device_id"), ping360_message("set_common_device_id"),
                        ping360_message("nack_not_recognised"), event(P360_A, struct.pack("<HH", 6, 2000)))
    whole = example("ping360", "transducer")
    yield "split", script(0, event(AS_IS | P360_A, whole[:9]), event(AS_IS | P360_B, b"\0\xff"),
                          event(AS_IS | P360_A, whole[9:]), event(P360_IMAGE, delay=130))
    yield "idle", script(0, scan, image, event(P360_NEXT_DUE, delay=255), event(P360_NEXT_DUE, delay=255), event(P360_NEXT_DUE, delay=255),
                         event(P360_NEXT_DUE, delay=255), event(P360_NEXT_DUE, delay=255))


def ping360_client_scripts():
    def meet(start):
        return (ping360_message("protocol_version", as_is=True) + ping360_message("device_information") +
                ping360_message("device_data_at_boot") + event(start))

    yield "turns", meet(P360_TURN) + 3 * ping360_message("device_data", delay=20)
    yield "scan", meet(P360_SCAN) + event(PAUSE, delay=50) + 3 * ping360_message("auto_device_data", delay=20) + event(
        P360_STOP) + ping360_message("ack_motor_off")
    yield "refused", meet(P360_TURN) + ping360_message("nack_sample_period")
    yield "timeouts", meet(P360_SCAN) + 2 * event(PAUSE, delay=250) + event(P360_STOP) + event(PAUSE, delay=150)
    yield "silent_head", event(P360_TURN) + event(PAUSE, delay=250)
    yield "small_talk", ping360_message("ascii_text") + ping360_message("set_device_id")


def ping360_frames():
    frames = {name: message["bytes"] for name, message in sorted(messages("ping360").items())}
    yield from frames.items()
    yield "stream", b"\0\xffUBR".join(frames.values())
    yield "discovery", b"Discovery"
    yield "set_ip", b"SetSS1IP 192.168.002.004"


def ping1d_messages():
    """Number and payload of each message."""
    for name, message in sorted(messages("ping1d").items()):
        yield name, message["bytes"][4:6] + message["bytes"][8:-2]


def ping1d_device_scripts():
    """Kinds of events and flags are those of the Ping360's script."""
    def say(name, kind=P360_A, delay=2):
        return event(AS_IS | kind, messages("ping1d")[name]["bytes"], delay)

    def script(flags, *events):
        return bytes([flags]) + b"".join(events)

    image = event(P360_IMAGE, delay=100)
    settings = b"".join(say(name) for name in ("set_mode_auto", "set_range", "set_speed_of_sound", "set_gain_setting",
                                               "set_ping_interval", "set_ping_enable"))
    yield "stream", script(0, say("continuous_start_profile"), 4 * image, say("continuous_stop_profile"))
    yield "settings", script(0, settings, say("continuous_start_distance_simple", P360_B), 3 * image)
    yield "requests", script(0, say("request_device_information"), event(P360_A, struct.pack("<HH", 6, 1300)), image,
                             event(P360_A, struct.pack("<H", 1211)), event(P360_A, struct.pack("<H", 1004)))
    yield "restart", script(0, say("continuous_start_profile"), say("goto_bootloader"), event(P360_FAILED), say("set_device_id"))
    yield "two_clients", script(FAN_OUT | TWO_CLIENTS, say("continuous_start_profile"), say("set_range", P360_B),
                                say("set_mode_auto", P360_SERIAL), image, event(P360_GONE))
    yield "next_ping_due", script(WAITS, say("continuous_start_profile"), 3 * (event(P360_NEXT_DUE) + image))
    yield "played", script(PLAYS_BACK, say("continuous_start_profile"), 3 * (event(P360_FEED) + image))


def sonar3d15_packets():
    """The first byte is the kind: 0 recording, 1 message, 2 block of Snappy."""
    packets = {name: message["bytes"] for name, message in sorted(messages("sonar3d15").items())}
    for name, packet in packets.items():
        yield name, bytes([2 if packet[3:4] == b"2" else 1]) + packet[8:-4]
    whole = b"".join(packets.values())
    yield "recording", b"\0" + whole
    yield "damaged", b"\0" + whole[:100] + b"?RIP" + whole[100:-3]


def sonar3d15_device_scripts():
    """Kinds of events are those of the Oculus's script."""
    def post(path, body, kind=OCULUS, delay=2):
        head = f"POST /api/v1/integration/{path} HTTP/1.1\r\nContent-Length: {len(body)}\r\n\r\n"
        return event(AS_IS | kind, head.encode() + body, delay)

    def script(flags, *events):
        return bytes([flags]) + event(OCULUS_CLIENT) + b"".join(events)

    image = event(OCULUS_IMAGE, delay=100)
    start = post("acoustics/enabled", b"true")
    yield "shots", script(0, start, post("output/imu-batch/enabled", b"true"), 4 * image, post("acoustics/enabled", b"false"))
    yield "settings", script(0, start, post("acoustics/mode", b'"high-frequency"'), post("acoustics/speed_of_sound", b"1450.5"),
                             post("acoustics/range", b'{"min": 0.5, "max": 4.0}', OCULUS_OTHER), 4 * image)
    yield "udp", script(0, start, *(post("udp", b'{"mode": "%s", "unicast_destination_ip": "10.0.0.1", "unicast_destination_port": 9}'
                                         % mode) + image for mode in (b"unicast", b"disabled", b"multicast")))
    yield "time", script(0, post("time/manual", b'{"now": "2026-01-01T00:00:00.5+01:00"}'), post("time/ntp", b'{"ntp_address": "a"}'),
                         post("time/ntp/force-sync", b'{"timeout_seconds": 1}'), event(OCULUS, b"\x8c"), event(OCULUS, b"\x87"))
    yield "wrong", script(0x10, post("acoustics/enabled", b'"enable"'), post("udp", b'{"mode": "disable"}'), post("nothing", b"{"),
                          event(AS_IS | OCULUS, b"POST / HTTP/1.0\r\n\r\n"))
    yield "too_hot", script(0x20, start, image)
    yield "failed", script(4, event(OCULUS_FAILED), image)
    yield "next_ping_due", script(2, start, 3 * (event(OCULUS_NEXT_DUE) + image))
    yield "played", script(1, start, 3 * (event(OCULUS_FEED) + image))


def glf_record(kind, body):
    return struct.pack("<cBIdBHHH", b"*", 2, 21 + len(body), 1479651753.25, kind, 1194, 100, 0) + body


def glf_image(lines, beams, raw=False, version=3):
    """protocol/glf/README.md 1.4"""
    pixels = bytes((3 * line + 5 * beam) % 256 for line in range(lines) for beam in range(beams))
    data = pixels if raw else zlib.compress(pixels, 9)
    compression = struct.pack("<H", raw) if version == 3 else b""
    head = struct.pack("<HHHIIHII", 1, 0xEFEF, version, 0, lines, 0, 0, beams) + compression + struct.pack("<I", len(data))
    tail = struct.pack("<IIfdHfhBBBBH", 0, 18750, 120.0, 1479651753.25, 0, 1500.0, 50, 0, 0, 0, 0, 0xDEDE)
    return glf_record(0, head + data + struct.pack(f"<{beams}d", *(1.0 - beam / beams for beam in range(beams))) + tail)


def glf_archive(entries, method, level=None):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method, compresslevel=level) as archive:
        for name, data in entries:
            archive.writestr(zipfile.ZipInfo(name), data, method, level)
    return out.getvalue()


def glf_logs():
    status, end = glf_record(3, bytes(218)), b"\xde\xde"
    dat = glf_image(20, 16) + status + glf_image(3, 4, raw=True) + end
    config = b"<genesisLog><logHeader><creationTime>1.5</creationTime></logHeader></genesisLog>"
    both = [("a.cfg", config), ("b.dat", dat)]
    yield "closed", dat
    yield "cut", dat[:-50]
    yield "other_types", glf_record(1, b"$GPGGA") + status + glf_record(99, bytes(20)) + end
    yield "older_versions", glf_image(8, 8, version=2) + glf_image(3, 4, raw=True, version=2) + end
    yield "damaged", glf_image(3, 4).replace(b"\xef\xef", b"\xef\xee") + status + end
    yield "stored", glf_archive(both, zipfile.ZIP_STORED)
    yield "stored_blocks", glf_archive(both, zipfile.ZIP_DEFLATED, 0)
    yield "compressed", glf_archive(both, zipfile.ZIP_DEFLATED, 9)


def mcap_record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def mcap_string(text):
    return struct.pack("<I", len(text)) + text


def zstd_frame(data):
    """One raw block, by RFC 8878: nothing is saved, but it is a frame."""
    return struct.pack("<IBH", 0xFD2FB528, 0x60, len(data) - 256) + struct.pack("<I", len(data) << 3 | 1)[:3] + data


def mcap_files():
    """Laid out by the MCAP specification, as tests/unit/protocol/mcap/bytes_test.cpp is."""
    magic = b"\x89MCAP0\r\n"
    head = magic + mcap_record(1, mcap_string(b"") + mcap_string(b"w"))
    schema = mcap_record(3, struct.pack("<H", 1) + mcap_string(b"S") + mcap_string(b"pb") + mcap_string(b"\7"))
    channel = mcap_record(4, struct.pack("<HH", 1, 1) + mcap_string(b"/c") + mcap_string(b"pb") + struct.pack("<I", 0))
    chunks = packed_chunks = b""
    for times in ((50, 10), (30, 60)):
        records = schema + channel
        entries = b""
        for sequence, time in enumerate(times):
            entries += struct.pack("<QQ", time, len(records))
            records += mcap_record(5, struct.pack("<HIQQ", 1, sequence, time, time) + b"data")
        times_and_size = struct.pack("<QQQI", min(times), max(times), len(records), zlib.crc32(records))
        chunks += mcap_record(6, times_and_size + mcap_string(b"") + struct.pack("<Q", len(records)) + records)
        # A text that readers skip, so that the chunk is long enough for the form of the frame.
        padded = records + mcap_record(99, bytes(256))
        packed = zstd_frame(padded)
        packed_chunks += mcap_record(6, struct.pack("<QQQI", min(times), max(times), len(padded), zlib.crc32(padded)) +
                                     mcap_string(b"zstd") + struct.pack("<Q", len(packed)) + packed)
        chunks += mcap_record(7, struct.pack("<HI", 1, len(entries)) + entries)
    data = head + chunks
    end = mcap_record(15, struct.pack("<I", zlib.crc32(data)))
    footer = struct.pack("<BQQQ", 2, 20, len(data) + len(end), 0)
    summary = schema + channel
    yield "no_end", data
    yield "cut", data[:-40]
    header_size = len(head) - 17 + len(chunks) // 2  # the header seems to contain the first chunk
    yield "header_over_a_chunk", magic + b"\1" + struct.pack("<Q", header_size) + head[17:] + chunks
    yield "compressed", head + packed_chunks
    growing = mcap_record(6, struct.pack("<QQQI", 70, 70, 35, 0) + mcap_string(b"") + struct.pack("<Q", 35) +
                          mcap_record(5, struct.pack("<HIQQ", 1, 2, 70, 70) + b"data"))
    yield "growing", data + growing + mcap_record(5, struct.pack("<HIQQ", 1, 3, 80, 80) + b"data")
    yield "no_chunk_index", data + end + summary + footer + struct.pack("<I", zlib.crc32(summary + footer)) + magic
    yield "no_summary_crc", data + end + summary + footer + struct.pack("<I", 0) + magic


def pcapng_block(kind, body):
    length = struct.pack("<I", len(body) + 12)
    return struct.pack("<I", kind) + length + body + length


def pcapng_files():
    section = pcapng_block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))
    interface = pcapng_block(1, struct.pack("<HHI", 101, 0, 0))
    packet = pcapng_block(6, struct.pack("<IIIII", 0, 1, 2, 5, 5) + b"hello\0\0\0")
    yield "two_packets", section + interface + 2 * packet
    yield "cut", (section + interface + packet)[:-5]


def ply_files():
    def header(encoding, count="3"):
        return ("ply\nformat %s 1.0\ncomment by hand\nelement vertex %s\nproperty float x\nproperty double y\n"
                "property short z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\n"
                "end_header\n" % (encoding, count)).encode()

    text = header("ascii") + b"0.5 +1e-1 -3 255\n1 0 0 0\n0 2 258 7\n3 0 1 2\n"
    vertices = [(0.5, 0.1, -3, 255), (1, 0, 0, 0), (0, 2, 258, 7)]

    def binary(order):
        return b"".join(struct.pack(order + "fdhB", *vertex) for vertex in vertices) + struct.pack(order + "Biii", 3, 0, 1, 2)

    yield "text", text
    yield "text_cut", text[:-9]
    yield "many", header("ascii", "18446744073709551615") + b"0 0 0 0\n"
    yield "mapped", (b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                     b"property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n"
                     b"element face 1\nproperty list uint8 uint32 vertex_index\nend_header\n"
                     b"0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n1 1 0 0 0 1 1 1\n0 1 0 0 0 1 0 1\n4 0 1 2 3\n")
    yield "little_endian", header("binary_little_endian") + binary("<")
    yield "big_endian", header("binary_big_endian") + binary(">")
    yield "binary_cut", header("binary_little_endian") + binary("<")[:-3]


def stl_files():
    text = (b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex +1e0 2 -0.5\nendloop\nendfacet\n"
            b"endsolid a\n")
    binary = b"solid".ljust(80) + struct.pack("<I", 2) + 2 * struct.pack("<12fH", 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0)
    yield "text", text
    yield "capitals", b"  " + 2 * text.upper()
    yield "text_cut", text[:-30]
    yield "binary", binary
    yield "binary_cut", binary[:-7]
    yield "binary_longer", b"x" + binary[1:] + b"notes"


def mavlink_crc(data):
    crc = 0xFFFF
    for byte in data:
        low = byte ^ (crc & 0xFF)
        low = (low ^ low << 4) & 0xFF
        crc = crc >> 8 ^ low << 8 ^ low << 3 ^ low >> 4
        crc &= 0xFFFF
    return crc


def mavlink_frame(message, seed, payload, version=2, flags=0):
    if version == 2:
        body = bytes([len(payload), flags, 0, 0, 1, 1]) + struct.pack("<I", message)[:3] + payload
    else:
        body = bytes([len(payload), 0, 1, 1, message]) + payload
    frame = bytes([0xFD if version == 2 else 0xFE]) + body + struct.pack("<H", mavlink_crc(body + bytes([seed])))
    return frame + (13 * b"s" if flags & 1 else b"")


def mavlink_datagrams():
    attitude = struct.pack("<I6f", 1000, 0.1, 0.2, 0.3, 1, 2, 3)
    quaternion = struct.pack("<I7f", 1000, 1, 0, 0, 0, 1, 2, 3)
    position = struct.pack("<I6f", 1000, 1, 2, 3, 4, 5, 6)
    odometry = struct.pack("<Q13f", 1000000, 1, 2, 3, 1, 0, 0, 0, 1, 2, 3, 4, 5, 6) + bytes(168) + bytes([1, 12])
    heartbeat = mavlink_frame(0, 50, bytes([0, 0, 0, 0, 12, 3, 81, 4, 3]))
    yield "pair", heartbeat + mavlink_frame(30, 39, attitude, 1) + mavlink_frame(32, 185, position)
    yield "quaternion_signed", mavlink_frame(31, 246, quaternion, flags=1) + heartbeat
    yield "odometry", mavlink_frame(331, 91, odometry)
    yield "among_others", mavlink_frame(1, 124, bytes(31)) + heartbeat + mavlink_frame(1, 124, bytes(31), 1)
    yield "broken", b"\xfd\x1e\0\xfe\xff" + mavlink_frame(32, 184, position) + mavlink_frame(32, 185, position[:9], 1)


def pose_streams():
    def frame(message):
        length = len(message)
        return bytes([length & 127 | 128, length >> 7]) + message if length > 127 else bytes([length]) + message

    alone = wire.pose_update(1_000_000_000, (1.0, -2.0, 3.0))
    with_body = wire.pose_update(2_000_000_000, (1.0, -2.0, 3.0), bodies=[("rov", (0.5, 0.0, 0.0))])
    yield "message", alone
    yield "message_with_body", with_body
    yield "stream", frame(alone) + frame(with_body) + frame(alone)
    yield "cut_stream", frame(alone) + frame(with_body)[:9]
    yield "length_beyond_the_limit", b"\xff\xff\x7f" + alone


def configurations():
    for path in sorted((EXAMPLES / "configs" / "broken").glob("*.yaml")):
        yield path.stem, path.read_bytes()
    for name in ("demo", "demo-micron", "demo-ping360", "two-vehicles-a"):
        yield name.replace("-", "_"), (CONFIGURATIONS / f"{name}.yaml").read_bytes()
    yield "unknown_key_twice", (EXAMPLES / "configs/broken/unknown_key.yaml").read_bytes() + b"soil: 1\nsoil: 2\n"


def sdf_worlds():
    for path in ("system/two_walls", "system/sphere_to_port", "worlds/harbour/quay/quay", "configs/broken/assets/malformed",
                 "public_worlds/nested_includes"):
        yield path.rsplit("/", 1)[1], (EXAMPLES / f"{path}.sdf").read_bytes()
    for name in ("uuv_lake", "dave_glider"):  # a saved state, flattened names
        yield name, (EXAMPLES / "public_worlds" / f"{name}.world").read_bytes()


def web_connections():
    def request(line, headers="", body=""):
        return f"{line} HTTP/1.1\r\nHost: 127.0.0.1:8014\r\n{headers}\r\n{body}".encode()

    def frame(payload, opcode=1):
        mask = bytes([1, 2, 3, 4])
        length = bytes([0x80 | len(payload)]) if len(payload) < 126 else struct.pack(">BH", 0x80 | 126, len(payload))
        return bytes([0x80 | opcode]) + length + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload))

    upgrade = ("Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n")
    yield "index", request("GET /")
    yield "status", request("GET /api/status")
    yield "metrics_and_health", request("GET /metrics") + request("HEAD /health", "Connection: close\r\n")
    yield "world", request("GET /api/world?x=1") + request("GET /nothing")
    yield "recording", request("POST /api/recording", "Content-Length: 12\r\nAuthorization: Bearer x\r\n", '{"on": true}')
    yield "chunked", request("POST /api/recording", "Transfer-Encoding: chunked\r\n",
                             '5\r\n{"on"\r\n7\r\n: true}\r\n0\r\n\r\n')
    yield "another_site", b"GET / HTTP/1.1\r\nHost: example.com\r\nOrigin: http://example.com\r\n\r\n"
    yield "live", (request("GET /api/live", upgrade) + frame(b'{"type": "want", "head": 0, "max_rows": 200}') +
                   frame(b'{"type": "want_status"}') + frame(b"{") + frame(b"", 9) + frame(b"", 8))
    yield "foxglove", (request("GET /", upgrade + "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n") +
                       frame(b'{"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]}') +
                       frame(b'{"op":"unsubscribe","subscriptionIds":[1]}') + frame(b"\x01abc", 2) + frame(b"", 8))


def web_messages():
    def script(protocol, *messages):
        return protocol + b"\n".join(messages)

    yield "live", script(b"l", b'{"type": "want", "head": 0, "max_rows": 200}', b'{"type": "want_status"}', b"{", b"")
    yield "live_numbers", script(b"l", b'{"type": "want", "head": -1, "max_rows": 1e99}', b'{"type": "want", "head": 18446744073709551615, '
                                       b'"max_rows": 0}', b'{"type": ["want"], "head": {}}')
    yield "foxglove", script(b"f", b'{"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":4294967296,"channelId":2}]}',
                             b'{"op":"unsubscribe","subscriptionIds":[1, "x", null]}')
    yield "foxglove_forms", script(b"f", b'{"op":"subscribe","subscriptions":{"id":1}}', b'{"op":"subscribe"}', b'{"op":7}', b"[]",
                                   b'{"op":"unsubscribe","subscriptionIds":' + b"[" * 200 + b"]" * 200 + b"}")
    yield "escapes", script(b"f", b'{"op":"\\u0000\\ud800"}', b'{"op":"subscribe","op":"unsubscribe"}')


def write(folder, name, data):
    target = CORPUS / folder
    target.mkdir(parents=True, exist_ok=True)
    (target / name).write_bytes(data)


def dvl_a50_texts():
    texts = {name: message["bytes"] for name, message in sorted(messages("dvl_a50").items()) if message["message"] != "pd4"}
    yield from texts.items()
    yield "stream", b"".join(text for text in texts.values() if text.startswith(b"{"))
    yield "time", b"2026-01-01T02:00:00.5+02:00"


def dvl_a50_device_scripts():
    """Bytes of a JSON client, the serial line and an HTTP client; the other kinds of events are those of the Ping360."""
    json, serial, http = range(3)

    def say(text, kind=json, delay=2):
        return event(kind, text, delay)

    def command(name, parameters="{}"):
        return say(f'{{"command":"{name}","parameters":{parameters}}}'.encode())

    def script(flags, *events):
        return bytes([flags]) + b"".join(events)

    image = event(P360_IMAGE, delay=100)
    yield "reports", script(0, command("get_config"), 4 * image, event(P360_GONE))
    yield "settings", script(0, command("set_config", '{"speed_of_sound":1500,"range_mode":"wt"}'), 3 * image,
                             command("reset_dead_reckoning"), command("get_version_info"))
    yield "triggers", script(0x10, 3 * command("trigger_ping"), 3 * image, command("calibrate_gyro"))
    yield "times", script(0, command("set_time_manual", '{"now":"2026-01-01T00:00:00Z"}'), command("get_time_status"),
                          command("force_sync_ntp", '{"timeout_seconds":1}'), event(P360_FAILED, delay=100))
    yield "serial", script(4, *(say(line, serial) for line in (b"wcv*fe\r\n", b"wcs,1450,,n,,,*c5\n", b"wcp,2\r", b"wcw")), image)
    yield "http", script(0, say(b"GET /api/v1/about HTTP/1.1\r\n\r\n", http), say(b"GET / HTTP/1.0\n\n", http))
    yield "next_due", script(2, command("get_config"), event(P360_NEXT_DUE, delay=100), image)
    yield "played", script(1, command("get_config"), event(P360_FEED), image)


def main():
    for device, folder in (("gemini", "gemini/datagrams"), ("micron", "micron/frames")):
        for name, message in messages(device).items():
            write(folder, name, message["bytes"])
    write("micron/frames", "stream", b"@\n@0008".join(
        frame for _, message in sorted(messages("micron").items()) if len(frame := message["bytes"]) < 34))
    for folder, scripts in (("gemini/device", device_scripts()), ("gemini/client", client_scripts()),
                            ("micron/device", micron_device_scripts()), ("micron/client", micron_client_scripts()),
                            ("oculus/device", oculus_device_scripts()), ("oculus/client", oculus_streams()),
                            ("ping360/frames", ping360_frames()), ("ping360/device", ping360_device_scripts()),
                            ("ping360/client", ping360_client_scripts()), ("ping1d/device", ping1d_device_scripts()), ("ping1d/messages", ping1d_messages()),
                            ("sonar3d15/packets", sonar3d15_packets()), ("sonar3d15/device", sonar3d15_device_scripts()),
                            ("dvl_a50/stream", dvl_a50_texts()), ("dvl_a50/device", dvl_a50_device_scripts()),
                            ("glf/log", glf_logs()), ("mcap", mcap_files()),
                            ("pcapng", pcapng_files()),
                            ("mavlink", mavlink_datagrams()), ("pose", pose_streams()),
                            ("configuration", configurations()), ("sdf", sdf_worlds()), ("ply", ply_files()),
                            ("stl", stl_files()), ("web", web_connections()), ("web_messages", web_messages())):
        for name, script in scripts:
            write(folder, name, script)


if __name__ == "__main__":
    main()
