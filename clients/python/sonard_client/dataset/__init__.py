# SPDX-License-Identifier: Apache-2.0
"""The parts of sonard_client.to_dataset."""
