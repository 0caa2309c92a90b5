#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Costs of rendering on several machines, and what they mean for up to 1,000 workers (docs/cluster.md).

    PYTHONPATH=build/release/python .venv/bin/python bench/cluster.py [--scene FILE] [--spp N] [--workers 1,2] [--part-seconds 2]

prints the times of one process and of Dask workers on this machine, of one thread each, and what a part costs: packing it on its worker, its
bytes, a round trip through the scheduler, adding it in the caller. Then it simulates a render with these costs.

    ... bench/cluster.py --network [--delay-ms 50] [--loss 1]

renders with two workers behind a link between two network namespaces (tests/python/lossy_link.py): each packet is 50 ms late in each direction, and
1 % of them are lost. It checks the bits.
"""
from __future__ import annotations

import argparse
import heapq
import itertools
import os
import random
import subprocess
import sys
import tempfile
import time

import numpy as np

import aureole
from aureole import _aureole, cluster

os.environ["AUREOLE_CACHE"] = "off"  # tables are computed at each start

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "python"))
from lossy_link import LossyLink  # noqa: E402

STREET = "scenes/condensation/condensation.xml"


def cpu_of_workers(client):
    """CPU seconds that the workers have spent."""
    return sum(client.run(time.process_time).values())


def rendered(scene, spp, client=None, **options):
    """Seconds, picture, and CPU seconds of the renderers and of the caller beside them."""
    begun, here = time.perf_counter(), time.process_time()
    if client is None:
        image = aureole.render(scene, spp, threads=1, progress=False)
        return time.perf_counter() - begun, image, time.process_time() - here, 0.0
    there = cpu_of_workers(client)
    image = cluster.render(scene, client, spp, progress=False, **options)
    seconds, caller_s = time.perf_counter() - begun, time.process_time() - here
    return seconds, image, cpu_of_workers(client) - there, caller_s


def costs(scene, spp):
    """Costs of a part of ten seconds: bytes, seconds of packing and of adding."""
    empty = _aureole.empty_picture(scene._open, spp, None, 1, None)
    total = _aureole.PartSum(empty)
    units = int(total.units)
    begun = time.perf_counter()
    picture, _ = _aureole.render(scene._open, 0, spp, None, 1, 1, 0.0, None, None, None, (0, max(1, units // 50)))
    rate = max(1, units // 50) / (time.perf_counter() - begun)
    part = min(units, int(10 * rate)) or 1
    picture, _ = _aureole.render(scene._open, 0, spp, None, 2, 1, 0.0, None, None, None, (0, part))
    times = []
    for _ in range(5):
        begun = time.perf_counter()
        packed = _aureole.packed_part(picture)
        middle = time.perf_counter()
        fresh = _aureole.PartSum(empty)
        before = time.perf_counter()
        fresh.add(packed, 0, part, [])
        times.append((middle - begun, time.perf_counter() - before))
    pack, add = np.min(times, axis=0)
    return {"units": units, "rate": rate, "bytes": len(packed), "pack_s": float(pack), "add_s": float(add)}


def nothing(number):
    return number


def round_trip(client):
    """Seconds of one task of a thousand that do nothing: the scheduler's share of a part."""
    begun = time.perf_counter()
    client.gather([client.submit(nothing, i, pure=False) for i in range(1000)])
    return (time.perf_counter() - begun) / 1000


def simulated(workers, units, rate, part_seconds, add_s, task_s, part_bytes, bytes_per_s, lengthen=True, seed=1):
    """Seconds of a render, and the parts of it that caller, scheduler and network were busy. Workers' speeds differ by 10 %; each has two parts, as
    in aureole/_cluster_pool.py. Caller, scheduler and network serve one part at a time."""
    draw = random.Random(seed)
    speed = [rate * draw.lognormvariate(0, 0.1) for _ in range(workers)]
    missing, done, now = units, 0, 0.0
    free = {"caller": 0.0, "scheduler": 0.0, "network": 0.0}
    busy = dict.fromkeys(free, 0.0)
    ready = [0.0] * workers  # when a worker has rendered what it has
    events, order = [], itertools.count()

    def serve(name, at, seconds):
        free[name] = max(at, free[name]) + seconds
        busy[name] += seconds
        return free[name]

    def ask(worker, at):
        nonlocal missing
        if missing <= 0:
            return
        part = min(missing, cluster.part_units(speed[worker], missing, workers, part_seconds, add_s if lengthen else 0.0))
        missing -= part
        there = serve("scheduler", at, task_s)
        ready[worker] = max(there, ready[worker]) + part / speed[worker]
        heapq.heappush(events, (ready[worker], next(order), worker, part))

    for worker in range(workers):
        ask(worker, 0.0)
        ask(worker, 0.0)
    while events:
        at, _, worker, part = heapq.heappop(events)
        sent = serve("network", at, part_bytes / bytes_per_s)
        now = serve("caller", sent, add_s)
        done += part
        ask(worker, now)
    assert done == units
    return now, {name: seconds / now for name, seconds in busy.items()}, sum(speed)


def simulate(c, hours, bytes_per_s):
    print(f"simulation: {hours:g} hours of one worker, parts of 10 s, {bytes_per_s * 1e-6:g} MB/s to the caller")
    print(f"{'workers':>8} {'parts':>10} {'seconds':>9} {'efficiency':>11} {'caller':>7} {'scheduler':>10} {'network':>8}")
    units = int(hours * 3600 * c["rate"])
    for workers in (1, 4, 16, 64, 256, 1000):
        for lengthen in (False, True):
            seconds, busy, speed = simulated(workers, units, c["rate"], 10.0, c["add_s"], c["task_s"], c["bytes"], bytes_per_s, lengthen)
            print(f"{workers:8} {'lengthened' if lengthen else '10 s':>10} {seconds:9.0f} {100 * units / speed / seconds:9.1f} % {100 * busy['caller']:5.0f} % "
                  f"{100 * busy['scheduler']:8.0f} % {100 * busy['network']:6.0f} %")


def start_dask(link, scheduler_host, worker_host, workers, port=8786):
    """Starts a scheduler on one host of the link and workers of one thread on the other. Returns the scheduler's address."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    address = f"tcp://{link.address(scheduler_host)}:{port}"

    def start(host, *words):
        link.start(host, [sys.executable, "-m", *map(str, words)], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    start(scheduler_host, "distributed.cli.dask_scheduler", "--host", link.address(scheduler_host), "--port", port, "--no-dashboard", "--no-show")
    for _ in range(workers):
        start(worker_host, "distributed.cli.dask_worker", address, "--host", link.address(worker_host), "--nthreads", 1, "--no-dashboard", "--no-nanny")
    return address


def across_a_network(arguments, scene):
    """Two workers behind a link that loses packets; the caller and the scheduler are on its other side."""
    problem = LossyLink.missing()
    if problem:
        sys.exit(f"no link can be made on this machine: {problem}")
    alone_s, alone, *_ = rendered(scene, arguments.spp)
    with LossyLink(1e-3 * arguments.delay_ms, 1e-2 * arguments.loss) as link, tempfile.TemporaryDirectory() as folder:
        address = start_dask(link, 0, 1, 2)
        picture = os.path.join(folder, "picture.npy")
        words = [__file__, "--scene", arguments.scene, "--spp", arguments.spp, "--caller", address, "--picture", picture]
        words += ["--delay-ms", arguments.delay_ms, "--loss", arguments.loss, "--part-seconds", arguments.part_seconds, *(word for define in arguments.D for word in ("-D", define))]
        caller = link.start(0, [sys.executable, *words], env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
        if caller.wait(timeout=900) != 0:
            sys.exit("the render failed")
        equal = np.array_equal(np.load(picture), alone.array)
        packets = link.passed + link.lost
        print(f"alone: {alone_s:.1f} s by one thread; {packets} packets, {100 * link.lost / packets:.2f} % of them lost, {link.sent_again(0)} and "
              f"{link.sent_again(1)} segments sent again by TCP; bits are equal: {equal}")
        if not equal:
            sys.exit(1)


def call(arguments, scene):
    """The caller of `across_a_network`, in its own network namespace."""
    import distributed

    with distributed.Client(arguments.caller, timeout=120) as client:
        client.wait_for_workers(2, timeout=120)
        times = []
        for number in range(5):
            begun = time.perf_counter()
            client.submit(nothing, number, pure=False).result()
            times.append(time.perf_counter() - begun)
        seconds, image, *_ = rendered(scene, arguments.spp, client, part_seconds=arguments.part_seconds)
        again_s, again, *_ = rendered(scene, arguments.spp, client, part_seconds=arguments.part_seconds)
        assert np.array_equal(image.array, again.array)
        np.save(arguments.picture, image.array)
        print(f"{arguments.delay_ms:g} ms, {arguments.loss:g} % lost: an empty task takes {1e3 * np.median(times):.0f} ms; {seconds:.1f} s by two workers that get the "
              f"scene first, {again_s:.1f} s by two that have it", flush=True)


def main():
    import distributed

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default=STREET)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("-D", action="append", default=["width=360", "height=240"])
    parser.add_argument("--workers", default="1,2")
    parser.add_argument("--part-seconds", type=float, default=2.0)
    parser.add_argument("--hours", type=float, default=1000.0)
    parser.add_argument("--megabytes", type=float, default=100.0, help="per second, from the workers to the caller")
    parser.add_argument("--network", action="store_true", help="two workers behind a slow link that loses packets")
    parser.add_argument("--delay-ms", type=float, default=50.0, help="of each packet, in each direction")
    parser.add_argument("--loss", type=float, default=1.0, help="percent of the packets, in each direction")
    parser.add_argument("--caller", help=argparse.SUPPRESS)
    parser.add_argument("--picture", help=argparse.SUPPRESS)
    a = parser.parse_args()
    scene = aureole.load_file(a.scene, **dict(d.split("=", 1) for d in a.D))
    if a.caller:
        call(a, scene)
        return
    if a.network:
        across_a_network(a, scene)
        return
    alone_s, alone, alone_cpu, _ = min((rendered(scene, a.spp) for _ in range(2)), key=lambda found: found[2])
    print(f"{a.scene} at {scene.size[0]} x {scene.size[1]}, {a.spp} samples: {alone_s:.2f} s by one thread, {alone_cpu:.2f} s of CPU")
    c = costs(scene, a.spp)
    for count in map(int, a.workers.split(",")):
        with distributed.Client(n_workers=count, threads_per_worker=1, processes=True, dashboard_address=":0") as client:
            rendered(scene, 16, client)  # loads the scene
            seconds, image, cpu, caller = min((rendered(scene, a.spp, client, part_seconds=a.part_seconds) for _ in range(2)), key=lambda found: found[0])
            c["task_s"] = round_trip(client)
            print(f"{count} workers: {seconds:.2f} s, {100 * alone_s / seconds / count:.1f} % of ideal; {cpu:.2f} s of CPU, {100 * alone_cpu / cpu:.1f} % of "
                  f"ideal, and {caller:.2f} s of the caller; bits are equal: {np.array_equal(image.array, alone.array)}")
    print(f"a part of 10 s: packed in {1e3 * c['pack_s']:.1f} ms to {c['bytes'] * 1e-3:.0f} kB, added in {1e3 * c['add_s']:.1f} ms; "
          f"{1e3 * c['task_s']:.2f} ms of the scheduler")
    simulate(c, a.hours, a.megabytes * 1e6)
    big = dict(c, add_s=c["add_s"] * 8, bytes=c["bytes"] * 8)
    print("eight times the pixels:")
    simulate(big, a.hours, a.megabytes * 1e6)


if __name__ == "__main__":
    main()
