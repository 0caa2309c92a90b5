#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two hosts on this machine with a slow link between them that loses packets.

Each host is a network namespace with a TUN device. This program passes IP packets from one device to the other, each late by a fixed time, and
drops packets at random. TCP of the kernel on both sides does the rest: it sends lost packets again.

    with LossyLink(delay_s=0.05, loss=0.01) as link:
        server = link.start(0, ["python3", "-m", "http.server", "--bind", link.address(0)])
        client = link.start(1, ["curl", f"http://{link.address(0)}:8000/"])

It needs /dev/net/tun and the right to make namespaces: root, or users' namespaces (`sysctl kernel.unprivileged_userns_clone`).
`LossyLink.missing()` says what is missing.
"""
from __future__ import annotations

import ctypes
import fcntl
import heapq
import itertools
import os
import random
import select
import signal
import socket
import struct
import subprocess
import threading
import time
from typing import Any, Dict, List, Optional, Sequence, Tuple

_CLONE_NEWUSER, _CLONE_NEWNET = 0x10000000, 0x40000000  # sched.h
_TUNSETIFF, _IFF_TUN, _IFF_NO_PI = 0x400454CA, 0x0001, 0x1000  # linux/if_tun.h
_SIOCSIFADDR, _SIOCSIFFLAGS, _SIOCSIFNETMASK, _SIOCSIFTXQLEN = 0x8916, 0x8914, 0x891C, 0x8943  # linux/sockios.h
_IFF_UP = 0x1
_libc = ctypes.CDLL(None, use_errno=True)


def _checked(result: int, what: str) -> None:
    if result != 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {os.strerror(number)}")


def _own_namespaces() -> bool:
    """Gives this process a network of its own, and where that needs root, users of its own first. Returns whether it has these."""
    if _libc.unshare(_CLONE_NEWNET) == 0:
        return False
    user, group = os.getuid(), os.getgid()
    _checked(_libc.unshare(_CLONE_NEWUSER | _CLONE_NEWNET), "a network namespace")
    for name, text in (("setgroups", "deny"), ("uid_map", f"0 {user} 1"), ("gid_map", f"0 {group} 1")):
        with open(f"/proc/self/{name}", "w") as file:
            file.write(text)
    return True


def _bring_up(name: str, address: Optional[str]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        if address is not None:
            for request, value in ((_SIOCSIFADDR, address), (_SIOCSIFNETMASK, "255.255.255.0")):
                fcntl.ioctl(control, request, struct.pack("16sH2s4s8x", name.encode(), socket.AF_INET, b"", socket.inet_aton(value)))
            fcntl.ioctl(control, _SIOCSIFTXQLEN, struct.pack("16si", name.encode(), 10000))
        fcntl.ioctl(control, _SIOCSIFFLAGS, struct.pack("16sH", name.encode(), _IFF_UP))


def _host(address: str, channel: socket.socket) -> None:
    """A child process: makes namespaces and device, sends the device to its parent, and holds both until the parent closes the channel."""
    try:
        has_users = _own_namespaces()
        device = os.open("/dev/net/tun", os.O_RDWR)
        fcntl.ioctl(device, _TUNSETIFF, struct.pack("16sH14x", b"link0", _IFF_TUN | _IFF_NO_PI))
        _bring_up("lo", None)
        _bring_up("link0", address)
        socket.send_fds(channel, [b"u" if has_users else b"n"], [device])
    except OSError as e:
        channel.send(b"e" + str(e).encode()[:200])
    channel.recv(1)


class LossyLink:
    """Two hosts, 0 and 1, and the link between them, while it is entered.

    Attributes
    ----------
    passed, lost : int
        Packets of both directions so far.
    """

    def __init__(self, delay_s: float, loss: float, seed: int = 1) -> None:
        self.delay_s, self.loss, self.passed, self.lost = delay_s, loss, 0, 0
        self._draw = random.Random(seed)
        self._hosts: List[Tuple[int, socket.socket]] = []
        self._devices: List[int] = []
        self._has_users = False
        self._started: List["subprocess.Popen[bytes]"] = []
        self._end_read, self._end_write = -1, -1
        self._thread: Optional[threading.Thread] = None

    @staticmethod
    def missing() -> str:
        """Empty where a link can be made here, or the reason why not."""
        try:
            with LossyLink(0.0, 0.0):
                return ""
        except OSError as e:
            return str(e)

    def address(self, host: int) -> str:
        return f"10.77.0.{host + 1}"

    def __enter__(self) -> LossyLink:
        try:
            for host in (0, 1):
                here, there = socket.socketpair()
                process = os.fork()
                if process == 0:
                    try:
                        here.close()
                        for _, channel in self._hosts:
                            channel.close()
                        signal.signal(signal.SIGINT, signal.SIG_IGN)
                        _host(self.address(host), there)
                    finally:
                        os._exit(0)
                there.close()
                self._hosts.append((process, here))
                answer, descriptors, _, _ = socket.recv_fds(here, 256, 1)
                if not descriptors:
                    raise OSError(answer[1:].decode(errors="replace") or "a network namespace could not be made")
                os.set_blocking(descriptors[0], False)
                self._devices.append(descriptors[0])
                self._has_users = answer == b"u"
        except BaseException:
            self.__exit__()
            raise
        self._end_read, self._end_write = os.pipe()
        self._thread = threading.Thread(target=self._forward, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: Any) -> None:
        for started in self._started:
            started.kill()
            started.wait()
        if self._thread is not None:
            os.close(self._end_write)
            self._thread.join()
            os.close(self._end_read)
        for device in self._devices:
            os.close(device)
        for process, channel in self._hosts:
            channel.close()
            os.waitpid(process, 0)

    def start(self, host: int, command: Sequence[str], **options: Any) -> "subprocess.Popen[bytes]":
        """Starts a program on a host; it is killed when the link is left. `options` are those of Popen."""
        namespaces = [(kind, os.open(f"/proc/{self._hosts[host][0]}/ns/{kind}", os.O_RDONLY)) for kind in (["user"] if self._has_users else []) + ["net"]]

        def enter() -> None:
            for kind, descriptor in namespaces:
                _checked(_libc.setns(descriptor, _CLONE_NEWUSER if kind == "user" else _CLONE_NEWNET), f"entering the namespace of {kind}")

        try:
            started = subprocess.Popen([str(word) for word in command], preexec_fn=enter, **options)
        finally:
            for _, descriptor in namespaces:
                os.close(descriptor)
        self._started.append(started)
        return started

    def sent_again(self, host: int) -> int:
        """Segments that TCP of this host has sent more than once."""
        with open(f"/proc/{self._hosts[host][0]}/net/snmp") as file:
            names, values = [line.split()[1:] for line in file if line.startswith("Tcp:")]
        found: Dict[str, str] = dict(zip(names, values))
        return int(found["RetransSegs"])

    def _forward(self) -> None:
        """Passes packets until the link is left."""
        late: List[Tuple[float, int, int, bytes]] = []
        order = itertools.count()
        while True:
            wait = max(0.0, late[0][0] - time.monotonic()) if late else None
            readable, _, _ = select.select([*self._devices, self._end_read], [], [], wait)
            if self._end_read in readable:
                return
            now = time.monotonic()
            for host, device in enumerate(self._devices):
                if device not in readable:
                    continue
                for _ in range(256):
                    try:
                        packet = os.read(device, 65536)
                    except OSError:  # no more for now
                        break
                    if self._draw.random() < self.loss:
                        self.lost += 1
                    else:
                        self.passed += 1
                        heapq.heappush(late, (now + self.delay_s, next(order), 1 - host, packet))
            now = time.monotonic()
            while late and late[0][0] <= now:
                _, _, target, packet = heapq.heappop(late)
                try:
                    os.write(self._devices[target], packet)
                except OSError:  # the device's queue is full, or the host refuses the packet: lost as well
                    self.lost += 1
