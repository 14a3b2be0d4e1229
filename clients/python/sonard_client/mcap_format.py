# SPDX-License-Identifier: Apache-2.0
"""Numbers of the MCAP container (mcap.dev/spec), for reader and writer."""

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = 1, 2, 3, 4, 5, 6, 7, 8
ATTACHMENT, STATISTICS, METADATA, SUMMARY_OFFSET, DATA_END = 9, 11, 12, 14, 15
