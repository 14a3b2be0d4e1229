# SPDX-License-Identifier: Apache-2.0
"""The messages in tests/data/DEVICE/messages.json (tests/data/messages.md)."""
import json
import pathlib

DATA = pathlib.Path(__file__).resolve().parents[1] / "data"


def messages(device):
    """All messages of a device, as dictionaries by name, with their bytes as bytes."""
    listed = json.loads((DATA / device / "messages.json").read_text(encoding="utf-8"))
    return {message["name"]: {**message, "bytes": bytes.fromhex("".join(message["bytes"]))} for message in listed}


def example(device, name):
    """The bytes of one message."""
    return messages(device)[name]["bytes"]
