# SPDX-License-Identifier: BSD-3-Clause
"""Runs programs side by side."""
import concurrent.futures


class Pool(concurrent.futures.ThreadPoolExecutor):
    """Starts nothing more when its block is left by an exception, such as by Ctrl-C."""

    def __exit__(self, kind, error, traceback):
        self.shutdown(cancel_futures=kind is not None)
        return False
