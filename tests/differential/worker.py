# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""Judges scenes in a process of its own, so that a crash is a verdict on a scene and not the end of the run.

Run as a program it reads seeds, a line each, and writes a pickled verdict for each to standard output.
"""

from __future__ import annotations

import logging
import pickle
import subprocess
import sys
import tempfile
from typing import IO

from compare import Verdict, judge
from reference import load


class Worker:
    """A process that judges one scene after another."""

    def __init__(self, effort: float) -> None:
        self._command = [sys.executable, __file__, str(effort)]
        self._process: subprocess.Popen[bytes] | None = None
        self._said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 -- a pipe that nobody reads would fill up

    def judge(self, seed: int) -> Verdict:
        """The verdict; one that says "crashed" where the process died."""
        if self._process is None:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                start_new_session=True,  # Ctrl-C is for the one that reports
            )
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(b"%d\n" % seed)
            process.stdin.flush()
            verdict = pickle.load(process.stdout)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            process.wait()
            self._said.seek(0)
            words = self._said.read().decode(errors="replace").strip().splitlines()
            self._process = None
            return Verdict(seed, crash=f"exit {process.returncode}: {words[-1] if words else 'without a word'}")
        assert isinstance(verdict, Verdict)
        return verdict

    def stop(self) -> None:
        """Ends the process, in the middle of a scene too; `judge` in another thread then returns."""
        if self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """Frees what the process has left; after `stop`, and when no thread is in `judge`."""
        if self._process is not None:
            self._process.communicate()
            self._process = None
        self._said.close()


def _serve(effort: float) -> None:
    logging.getLogger("sunfleck").setLevel(logging.ERROR)  # black pictures are none of its business
    library = load()
    for line in sys.stdin:
        pickle.dump(judge(int(line), library, effort), sys.stdout.buffer)
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    _serve(float(sys.argv[1]))
