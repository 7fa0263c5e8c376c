#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a client of ParaView with a server of its own.

with_pvserver.py SECONDS PVSERVER [ARGUMENT...] -- CLIENT [ARGUMENT...]

The client finds HOST:PORT in MCOR_TEST_SERVER. What the server writes goes to a file, and is shown if
something fails: a pipe that nobody reads would fill up and stop the server. After SECONDS the script shows
the stacks of client and server, if there is gdb, and ends both. Then it waits until ctest ends the script
and counts the test as one whose time ran out: see TIMEOUT_AFTER_MATCH.

What to look for in the stacks: at a crash, or SIGTERM ("timeout" without -k), ParaView's signal handler writes
a stack, and calls malloc(). If the signal came within malloc() or free(), the handler waits for ever for a lock
of its own thread, which looks like a standstill. The signal's place stands below "signal handler called".
"""
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

START_SECONDS = 200  # The server loads some hundred libraries, perhaps on a busy machine.
STOP_SECONDS = 30


def free_port():
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


def end(process):
    """Kills the process and all processes of its group."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
    process.wait()


def start_server(command, log):
    """Starts the server and waits until it accepts a client. Returns the server (None if it failed) and its port. The server takes one
    client, and ends with it."""
    port = free_port()
    server = subprocess.Popen([*command, f"--server-port={port}"], stdin=subprocess.DEVNULL, stdout=log,
                              stderr=subprocess.STDOUT, start_new_session=True)
    deadline = time.monotonic() + START_SECONDS
    while time.monotonic() < deadline and server.poll() is None:
        if b"Accepting connection" in read(log):
            return server, port
        time.sleep(0.1)
    end(server)
    return None, port


def read(log):
    return os.pread(log.fileno(), 1 << 20, 0)


def show_stacks(*processes):
    for process in processes:
        if process.poll() is None and shutil.which("gdb"):
            subprocess.run(["gdb", "-p", str(process.pid), "-batch", "-ex", "thread apply all bt 30"],
                           stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=100, check=False)


def run_client(command, server, port, seconds):
    """Returns the client's exit status, or None if it did not end in time."""
    client = subprocess.Popen(command, env={**os.environ, "MCOR_TEST_SERVER": f"localhost:{port}"},
                              stdin=subprocess.DEVNULL, start_new_session=True)
    try:
        return client.wait(seconds)
    except subprocess.TimeoutExpired:
        show_stacks(client, server)
        return None
    finally:
        end(client)


def main(seconds, server_command, client_command):
    with tempfile.TemporaryFile() as log:
        for _ in range(3):  # Another program may take the port in between.
            log.truncate(0)
            log.seek(0)
            server, port = start_server(server_command, log)
            if server:
                break
        else:
            sys.exit("the server did not start: " + read(log).decode(errors="replace"))
        try:
            status = run_client(client_command, server, port, seconds)
            if status == 0:
                status = server.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            print(f"the server goes on {STOP_SECONDS} s after its client", flush=True)
            show_stacks(server)
            status = None
        finally:
            end(server)
        if status != 0:
            print("status", status, "and the server wrote:", read(log).decode(errors="replace")[-8000:], sep="\n")
            if status is None:
                print(f"no end after {seconds:g} s", flush=True)
                time.sleep(STOP_SECONDS)
            sys.exit(1)


if __name__ == "__main__":
    if len(sys.argv) < 5 or "--" not in sys.argv:
        sys.exit(__doc__)
    split = sys.argv.index("--")
    main(float(sys.argv[1]), sys.argv[2:split], sys.argv[split + 1:])
