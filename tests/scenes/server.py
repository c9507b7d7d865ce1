"""Runs the program many times in processes that stay, one for each number of ranks: see server.cc. Standard library only."""
import atexit
import collections
import json
import os
import subprocess
import tempfile
import threading

from program import STROMA, check, command

Done = collections.namedtuple("Done", "returncode stdout stderr")


class Server:
    """The program on this many ranks, started once."""

    def __init__(self, ranks):
        words = command([], ranks)[:-1] + [os.path.join(os.path.dirname(STROMA), "tests", "scenes_server")]
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def run(self, arguments):
        """Exit code, standard output and standard error; no exit code where the program ended or hung."""
        with tempfile.TemporaryDirectory(prefix="stroma-said-") as said:
            files = [os.path.join(said, name) for name in ("output", "error")]
            guard = threading.Timer(1000, self.process.kill)
            guard.start()
            try:
                self.process.stdin.write(json.dumps({"arguments": arguments, "output": files[0], "error": files[1]}) + "\n")
                self.process.stdin.flush()
                code = self.process.stdout.readline()
            except BrokenPipeError:
                code = ""
            guard.cancel()
            texts = [open(path).read() if os.path.exists(path) else "" for path in files]
        return Done(int(code) if code else None, *texts)

    def stop(self):
        self.process.stdin.close()
        self.process.wait()


_servers = {}


def run(arguments, ranks=1, expect=0):
    """As run() of program.py, without a start for each run."""
    if ranks not in _servers:
        _servers[ranks] = Server(ranks)
        atexit.register(_servers[ranks].stop)
    done = _servers[ranks].run(arguments)
    check(done.returncode == expect, f"exit code {done.returncode} instead of {expect}: {done.stdout[-2000:]}{done.stderr}")
    return done
