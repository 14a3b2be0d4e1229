#!/usr/bin/env python3
"""Writes the fuzzing seeds in corpus/gemini from the byte examples in tests/data/gemini.

datagrams/  one example each, as it is
device/     scripts for fuzz_gemini_device: what a surface sends to a head, with time between
surface/    scripts for fuzz_gemini_surface: what a head sends to a surface

The form of a script is described in script.hpp. Run it again after adding an example; files that are there
for another reason (inputs that once failed) are left alone.
"""
import pathlib
import struct

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "data" / "gemini"
CORPUS = HERE / "corpus" / "gemini"

# Kinds of events, as in the programs.
FROM_A, FROM_B, TRIGGER, WATER, IMAGE, IMAGE_FAILED = range(6)
FROM_HEAD, START_SINGLE, START_CONTINUOUS, STOP, PAUSE = 0, 4, 5, 6, 7


def example(name):
    return bytes.fromhex((EXAMPLES / f"{name}.hex").read_text())


def event(kind, datagram=None, delay=2):
    """delay squared times 0.1 ms pass before the event."""
    head = bytes([kind, delay])
    return head if datagram is None else head + struct.pack("<H", len(datagram)) + datagram


def patched(name, offset, form, value):
    data = bytearray(example(name))
    struct.pack_into(form, data, offset, value)
    return bytes(data)


def device_scripts():
    single = patched("ping_config", 22, "<H", 40)
    continuous = bytearray(single)
    struct.pack_into("<H", continuous, 16, 1)
    ping = event(FROM_A, single) + event(IMAGE) + event(PAUSE, delay=20)
    yield "single_ping", event(FROM_A, example("status_request")) + ping
    yield "retries", ping + b"".join(
        event(FROM_A, patched(name, 10, "<H", 5)) for name in ("retry_line", "retry_tail", "observed_retry_lines"))
    yield "continuous", event(FROM_A, bytes(continuous)) + 4 * (event(IMAGE) + event(PAUSE, delay=40))
    yield "silence_and_resume", event(FROM_A, bytes(continuous)) + event(IMAGE) + event(PAUSE, delay=200) + event(
        FROM_A, example("status_request")) + event(IMAGE)
    yield "run_length", event(FROM_A, single[:54] + b"\x32\x00" + single[56:]) + event(IMAGE) + event(PAUSE)
    yield "sixteen_bit", event(FROM_A, single[:18] + b"\x00\x02" + single[20:]) + event(IMAGE) + event(PAUSE)
    yield "compressed", event(FROM_A, single[:52] + b"\x02\x00" + single[54:]) + event(IMAGE) + event(PAUSE)
    yield "trigger", event(FROM_A, single[:16] + b"\x02\x00" + single[18:]) + event(TRIGGER) + event(IMAGE)
    yield "out_of_water", event(WATER) + event(FROM_A, single[:18] + b"\x04\x00" + single[20:]) + event(WATER) + ping
    yield "failed_image", event(FROM_A, single) + event(IMAGE_FAILED) + ping
    yield "two_surfaces", ping + event(FROM_B, single) + event(IMAGE) + event(FROM_A, example("status_request"))
    yield "reboot", event(FROM_A, example("observed_info_block_write")) + event(FROM_A, example("observed_reboot")) + event(
        PAUSE, delay=250) + ping
    yield "session", b"".join(
        event(FROM_A, example(name), delay=5)
        for name in ("mdio_commands", "status_request", "observed_diagnostic_request", "network_config")
    ) + ping + event(FROM_A, example("observed_going_offline"))
    yield "production", b"".join(
        event(FROM_A, example(name)) for name in (
            "flash_read", "info_block_read", "info_block_write_identity", "serial_transmit", "test_result_request",
            "production_test", "power_on_self_test", "abort_production_test", "tx_drive_test", "gpo_write", "gpio_read"))
    yield "flash_write", event(FROM_A, example("flash_write")) + event(FROM_A, example("flash_read"))


def ping_datagrams(lines, resent=()):
    """Head, lines and tail of a ping; the lines of `resent` come after the tail."""
    line = example("ping_line")

    def numbered(number, flag=0):
        info = 0x2044 if number == lines - 1 else 0x2004
        return line[:10] + struct.pack("<HHH", number | flag, 0x1E00, info) + line[16:]

    yield patched("ping_head", 22, "<H", lines)
    for number in range(lines):
        if number not in resent:
            yield numbered(number)
    yield example("ping_tail")
    for number in resent:
        yield numbered(number, 0x8000)
    if resent:
        yield example("ping_tail_resent")


def surface_scripts():
    meet = event(FROM_HEAD, example("status")) + event(FROM_HEAD, example("status"))

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
    yield "small_talk", meet + event(FROM_HEAD, example("acknowledge")) + event(
        FROM_HEAD, example("diagnostic")) + event(FROM_HEAD, example("gpi_data"))


def write(folder, name, data):
    target = CORPUS / folder
    target.mkdir(parents=True, exist_ok=True)
    (target / name).write_bytes(data)


def main():
    for path in sorted(EXAMPLES.glob("*.hex")):
        write("datagrams", path.stem, example(path.stem))
    for name, script in device_scripts():
        write("device", name, script)
    for name, script in surface_scripts():
        write("surface", name, script)


if __name__ == "__main__":
    main()
