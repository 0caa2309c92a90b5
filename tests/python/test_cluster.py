# SPDX-License-Identifier: Apache-2.0
"""Rendering by Dask: the same bits as on one machine whatever happens to workers, and parts that are not what was asked for."""
import contextlib
import dataclasses
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest
from lossy_link import LossyLink

import aureole
from aureole import _aureole, _cluster_pool, _cluster_worker, cluster

distributed = pytest.importorskip("distributed", reason="rendering on a cluster needs Dask: pip install distributed")

SCENE = """<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="100"/><integer name="height" value="70"/></film>
    <sampler type="independent"><integer name="sample_count" value="48"/></sampler></sensor>
  <emitter type="constant"><rgb name="radiance" value="0.4, 0.5, 0.7"/></emitter>
  <shape type="obj"><string name="filename" value="models/quad.obj"/>
    <bsdf type="diffuse" id="wood"><texture type="bitmap" name="reflectance"><string name="filename" value="wood.png"/></texture></bsdf></shape>
</scene>"""
TWO_WAY = """<scene version="3.0.0">
  <integrator type="bdpt"/>
  <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="30"/></film>
    <sampler type="sobol"><integer name="sample_count" value="32"/></sampler></sensor>
  <shape type="sphere"><point name="center" x="0" y="0" z="4"/><bsdf type="plastic"/></shape>
  <shape type="sphere"><point name="center" x="1.5" y="2" z="3"/><float name="radius" value="0.3"/><emitter type="area"/></shape>
</scene>"""
MAP = """<scene version="3.0.0">
  <integrator type="ptracer"/>
  <sensor type="powermap"><film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/>
    <string name="wavelength_min" value="10.6cm"/><string name="wavelength_max" value="10.8cm"/><string name="response" value="uniform"/>
    <rfilter type="box"/></film><sampler type="sobol"><integer name="sample_count" value="32"/></sampler></sensor>
  <emitter type="point"><point name="position" x="0.2" y="0.3" z="1"/></emitter>
</scene>"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene")
    (folder / "models").mkdir()
    (folder / "models" / "quad.obj").write_text("v -1 -1 4\nv 1 -1 4\nv 1 1 4\nv -1 1 4\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 4/4 3/3 2/2 1/1\n")
    aureole.Image(np.random.default_rng(1).uniform(0, 1, (8, 8, 3))).save(folder / "wood.png")
    aureole.Image(np.full((8, 8, 3), 0.2)).save(folder / "dark.png")
    (folder / "scene.xml").write_text(SCENE)
    return aureole.load_file(folder / "scene.xml")


@pytest.fixture(scope="module")
def alone(scene):
    return aureole.render(scene, progress=False)


@contextlib.contextmanager
def workers_here(count):
    with distributed.LocalCluster(n_workers=count, threads_per_worker=1, processes=True, dashboard_address=":0") as workers:
        with distributed.Client(workers) as client:
            yield client


@pytest.fixture(scope="module")
def client():
    with workers_here(2) as client:
        yield client


@pytest.fixture
def on_one_worker(client, request):
    """Makes one worker run another `render_part`: `on_one_worker(change)`, with a function that takes the right one and returns another."""
    import cloudpickle

    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    address = sorted(client.nthreads())[0]

    def install(change):
        from aureole import _cluster_worker as worker

        worker.right = worker.render_part
        worker.render_part = change(worker.render_part)

    def restore():
        from aureole import _cluster_worker as worker

        worker.render_part = worker.right

    def start(change):
        client.run(install, change, workers=[address])
        request.addfinalizer(lambda: client.run(restore, workers=[address]))
        return address

    return start


def same(a, b):
    return np.array_equal(a.array, b.array) and (a.variance is None or np.array_equal(a.variance, b.variance))


def test_a_bundle_has_all_files(scene, tmp_path, monkeypatch):
    of = cluster.bundle(scene)
    assert sorted(os.path.basename(path) for path, _, _ in of.files) == ["quad.obj", "wood.png"]
    assert not any(path in of.text for path, _, _ in of.files)
    shelf = _cluster_worker._Shelf()
    monkeypatch.setattr(_cluster_worker, "shelf", shelf)
    here = _cluster_worker.describe()
    answer = _cluster_worker.open_scene(of, here)
    assert answer.kind == "missing" and len(answer.missing) == 2
    for number, (path, digest, size) in enumerate(of.files):
        content = open(path, "rb").read()
        assert size == len(content)
        if number == 0:
            assert _cluster_worker.receive(digest, 0, size, content[:-1] + b"?") == "damaged"
            assert _cluster_worker.receive(digest, 0, size, content[:5]) == "more"
            assert _cluster_worker.receive(digest, 5, size, content[5:]) == "whole"
        assert _cluster_worker.receive(digest, 0, size, content) == "whole"
    assert _cluster_worker.open_scene(of, here).kind == "ready"
    assert shelf.scene(of.key)[0].hash == scene.hash
    other = _cluster_worker.open_scene(of, ("0.0.1", here[1]))
    assert other.kind == "refused" and "it has aureole" in other.text
    changed = _cluster_worker.open_scene(dataclasses.replace(of, text=of.text.replace("0.4", "0.3")), here)
    assert changed.kind == "refused" and "has another hash there" in changed.text


def test_the_same_bits_with_one_two_and_four_workers(scene, alone, client):
    seen = []
    image = cluster.render(scene, client, part_seconds=0.1, progress=lambda *facts: seen.append(facts), on_picture=lambda i: seen.append(i))
    assert same(image, alone) and image.samples == 48 and image.complete
    assert seen and any(isinstance(s, aureole.Image) for s in seen)
    done = [s[:2] for s in seen if isinstance(s, tuple)]
    assert done == sorted(done) and done[-1][0] == done[-1][1]
    for count in (1, 4):
        with distributed.Client(n_workers=count, threads_per_worker=1, processes=False, dashboard_address=":0") as one:
            assert same(cluster.render(scene, one, part_seconds=0.1, progress=False), alone)


def test_replicates_verified(scene, client):
    many = cluster.render(scene, client, 32, seed=5, replicates=2, verify=0.5, part_seconds=0.1, progress=False)
    assert same(many, aureole.render(scene, 32, seed=5, replicates=2, progress=False))


def test_one_worker_verifies_nothing_and_says_so(scene, alone):
    with distributed.Client(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0") as one:
        with pytest.warns(UserWarning, match="no part was verified"):
            assert same(cluster.render(scene, one, verify=1, progress=False), alone)


def test_adaptive_samples(scene, client):
    image = cluster.render(scene, client, adaptive="absolute", part_seconds=0.1, progress=False)
    assert same(image, aureole.render(scene, adaptive="absolute", progress=False))


@pytest.mark.parametrize("text", [TWO_WAY, MAP], ids=["two_way", "map"])
def test_light_that_reaches_any_pixel(text, client):
    scene = aureole.load_string(text)
    assert same(cluster.render(scene, client, part_seconds=0.1, progress=False), aureole.render(scene, progress=False))


def test_resumes_from_a_checkpoint(scene, alone, client, tmp_path):
    state = tmp_path / "a.state"
    sum_of_parts = _aureole.PartSum(_aureole.empty_picture(scene._open, 48, None, 1, None))
    picture, _ = _aureole.render(scene._open, 0, 48, None, 0, 1, 0.0, None, None, None, (7, 60))
    sum_of_parts.add(_aureole.packed_part(picture), 7, 60, [])
    state.write_bytes(sum_of_parts.state())
    first = []
    image = cluster.render(scene, client, checkpoint=state, progress=lambda *facts: first.append(facts[0]))
    assert same(image, alone) and first[0] >= 53
    with pytest.raises(aureole.Error, match="belongs to another picture"):
        cluster.render(scene, client, seed=9, checkpoint=state, progress=False)


def test_an_interrupted_render_goes_on(scene, alone, client, tmp_path):
    class Enough(Exception):
        pass

    def stop(done, units, seconds, rate):
        if done > units / 4:
            raise Enough

    with pytest.raises(Enough):
        cluster.render(scene, client, part_seconds=0.1, checkpoint=f"file://{tmp_path}/b.state", progress=stop)
    before = _aureole.PartSum(_aureole.empty_picture(scene._open, 48, None, 1, None))
    before.resume((tmp_path / "b.state").read_bytes(), "b.state")
    assert sum(end - begin for begin, end in before.done) >= before.units / 4
    assert same(cluster.render(scene, client, checkpoint=f"file://{tmp_path}/b.state", progress=False), alone)


def test_parts_that_are_not_what_was_asked_for(scene):
    """The checks of a part, without a cluster."""
    job = cluster.Job(48, None, 1, None, 1)
    picture, _ = _aureole.render(scene._open, 0, 48, None, 1, 1, 0.0, None, None, None, (3, 9))
    good = _cluster_worker.Part(_aureole.packed_part(picture), [], 0.1)
    parts = cluster._Parts(cluster.bundle(scene), job, _aureole.PartSum(_aureole.empty_picture(scene._open, 48, None, 1, None)), 1.0, 0.0, None, None)
    worker = _cluster_pool.Worker("tcp://1", 1)
    part = lambda **changes: dataclasses.replace(good, **changes)
    assert "expected 3 to 9" in parts.arrived((3, 10, 0), worker, good)  # fewer units
    assert "no part" in parts.arrived((3, 9, 0), worker, b"nonsense")
    assert "damaged" in parts.arrived((3, 9, 0), worker, part(packed=good.packed[:-20]))
    assert "damaged" in parts.arrived((3, 9, 0), worker, part(packed=b"nonsense"))
    other, _ = _aureole.render(scene._open, 0, 48, 7, 1, 1, 0.0, None, None, None, (3, 9))
    assert "another picture" in parts.arrived((3, 9, 0), worker, part(packed=_aureole.packed_part(other)))
    assert parts.arrived((3, 9, 0), worker, part(invalid=[("a",)])) is not None
    assert not parts.is_done((3, 9, 0)) and worker.rate is None
    assert parts.arrived((3, 9, 0), worker, good) is None and parts.is_done((3, 9, 0)) and worker.rate == pytest.approx(60)


def test_a_worker_that_lies_about_its_parts_is_not_used(scene, alone, client, on_one_worker):
    def other_units(right):
        return lambda key, job, units, start: right(key, job, (0, 1), start)

    address = on_one_worker(other_units)
    with pytest.warns(UserWarning, match=f"{address} is not used: 3 of its parts were late, lost or wrong"):
        assert same(cluster.render(scene, client, part_seconds=0.1, progress=False), alone)


def forged(state):
    """A state file with one number of the film changed, and the checksum that fits (render/state.cpp)."""
    changed = bytearray(state[:-8])
    changed[-1000] ^= 64
    h, prime, mask = 0xCBF29CE484222325, 0x100000001B3, (1 << 64) - 1
    for at in range(0, len(changed) - 7, 8):
        h = ((h ^ int.from_bytes(changed[at:at + 8], "little")) * prime) & mask
        h ^= h >> 29
    for byte in changed[len(changed) // 8 * 8:]:
        h = ((h ^ byte) * prime) & mask
    return bytes(changed) + h.to_bytes(8, "little")


def test_a_worker_that_computes_wrongly_is_found(scene, client, on_one_worker, tmp_path):
    def other_bits(right):
        def changed(key, job, units, start):
            part = right(key, job, units, start)
            scene = _cluster_worker.shelf.scene(key)[0]
            made = _aureole.PartSum(_aureole.empty_picture(scene._open, job.spp, job.seed, job.replicates, job.adaptive))
            made.add(part.packed, *units, [])
            made.resume(forged(made.state()), "forged")
            return dataclasses.replace(part, packed=_aureole.packed_part(made.picture()))

        return changed

    address = on_one_worker(other_bits)
    with pytest.raises(aureole.Error, match=f"{address}.* rendered different bits of the units"):
        cluster.render(scene, client, 16, part_seconds=0.1, verify=1, checkpoint=tmp_path / "a.state", progress=False)
    assert not (tmp_path / "a.state").exists()


def test_a_slow_worker_costs_little(scene, alone, client, on_one_worker):
    def slow(right):
        def changed(*arguments):
            time.sleep(6)
            return right(*arguments)

        return changed

    on_one_worker(slow)
    begun = time.monotonic()
    assert same(cluster.render(scene, client, part_seconds=0.1, progress=False), alone)
    assert time.monotonic() - begun < 5  # its parts were given to the other one


def test_a_worker_that_dies(scene):
    expected = aureole.render(scene, 512, progress=False)
    with workers_here(2) as client:
        pids = list(client.run(os.getpid).values())
        killer = threading.Timer(0.7, lambda: os.kill(pids[0], signal.SIGKILL))
        killer.start()
        image = cluster.render(scene, client, 512, part_seconds=0.2, progress=False)
        killer.join()
        assert same(image, expected)


def test_a_scheduler_that_is_started_again(scene, tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    address = f"tcp://127.0.0.1:{port}"

    def start(*words):
        return subprocess.Popen([sys.executable, "-m", "distributed.cli." + words[0], *words[1:]], cwd=tmp_path, env=environment,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def both():
        return [start("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard", "--no-show"),
                start("dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")]

    running = both()
    try:
        with distributed.Client(address, timeout=60) as client:
            client.wait_for_workers(1, timeout=60)
            seen = []

            def restart(done, units, seconds, rate):
                if done > 0 and not seen:
                    seen.append(done)
                    for process in running:
                        process.kill()
                        process.wait()
                    running[:] = both()

            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                image = cluster.render(scene, client, 128, part_seconds=0.3, progress=restart)
            assert seen and same(image, aureole.render(scene, 128, progress=False))
    finally:
        for process in running:
            process.kill()
            process.wait()


CALLER = """
import sys
import numpy as np
from distributed import Client
import aureole, aureole.cluster
file, address, picture = sys.argv[1:]
with Client(address, timeout=60) as client:
    client.wait_for_workers(2, timeout=60)
    np.save(picture, aureole.cluster.render(aureole.load_file(file), client, part_seconds=0.2, progress=False).array)
"""


def test_two_workers_behind_a_link_that_loses_packets(scene, alone, tmp_path):
    """The caller and the scheduler on one host, the workers on another: 50 ms in each direction, and one packet of 30 is lost."""
    if missing := LossyLink.missing():
        pytest.skip(f"no link between network namespaces can be made on this machine: {missing}")
    options = {"env": {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}, "cwd": tmp_path, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with LossyLink(delay_s=0.05, loss=1 / 30) as link:
        address = f"tcp://{link.address(0)}:8786"
        dask = [sys.executable, "-m"]
        link.start(0, [*dask, "distributed.cli.dask_scheduler", "--host", link.address(0), "--port", 8786, "--no-dashboard", "--no-show"], **options)
        for _ in range(2):
            link.start(1, [*dask, "distributed.cli.dask_worker", address, "--host", link.address(1), "--nthreads", 1, "--no-dashboard", "--no-nanny"], **options)
        caller = link.start(0, [sys.executable, "-c", CALLER, scene._open.file, address, tmp_path / "picture.npy"], **{**options, "stderr": subprocess.PIPE})
        _, problems = caller.communicate(timeout=240)
        assert caller.returncode == 0, problems.decode()
        assert np.array_equal(np.load(tmp_path / "picture.npy"), alone.array)
        assert link.lost > 5 and link.sent_again(0) + link.sent_again(1) > 0


def test_rows_of_a_sweep(scene, client, tmp_path):
    radiance = next(path for path in scene.paths() if path.endswith("radiance"))
    dark = os.path.join(os.path.dirname(scene._open.file), "dark.png")
    table = [{radiance: [v, v, v]} for v in (0.1, 0.2)] + [{"nothing.there": 1}, {"wood.reflectance.filename": dark}]
    mean = lambda image: float(image.array.mean())
    rows = cluster.sweep(scene, client, table, 16, measure=mean, progress=False)
    assert rows[1].value == pytest.approx(2 * rows[0].value, rel=1e-4)
    assert rows[2].value is None and "nothing" in rows[2].problem
    assert [row.edits for row in rows] == table
    there = aureole.load_string(scene.xml())
    there.update({"wood.reflectance.filename": dark})
    assert rows[3].value == mean(aureole.render(there, 16, progress=False))


def test_stores(scene, alone, client, tmp_path):
    assert same(cluster.render(scene, client, store=f"file://{tmp_path}/store", part_seconds=0.1, progress=False), alone)
    assert sorted(os.listdir(tmp_path / "store")) == sorted(digest for _, digest, _ in cluster.bundle(scene).files)
    with distributed.Client(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=":0") as here:
        _cluster_worker.shelf = _cluster_worker._Shelf()  # has no files yet
        image = cluster.render(scene, here, store="memory://aureole", checkpoint="memory://a.state", progress=False)
        assert same(image, alone)
        assert same(cluster.render(scene, here, checkpoint="memory://a.state", progress=False), alone)
    with pytest.raises(aureole.Error, match="store: expected a URL"):
        cluster.render(scene, client, store="folder", progress=False)


def test_command(scene, alone, tmp_path):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PATH": os.path.dirname(sys.executable) + os.pathsep + os.environ["PATH"]}
    run = lambda *words: subprocess.run([os.environ["AUREOLE_BINARY"], "cluster", *words], capture_output=True, text=True, cwd=tmp_path, env=environment)
    done = run("render", scene._open.file, "--local", "1", "-o", "a.exr", "-q")
    assert done.returncode == 0, done.stderr
    np.testing.assert_allclose(aureole.read_image(tmp_path / "a.exr").array, alone.array, rtol=1e-3)
    assert (tmp_path / "a.png").exists() and not (tmp_path / "a.state").exists()
    wrong = run("render", "none.xml", "--local", "1")
    assert wrong.returncode == 2 and "none.xml" in wrong.stderr
    assert run("render", scene._open.file).returncode == 2
    assert "--scheduler ADDRESS" in run("render", "--help").stdout
    with socket.socket() as unheard:  # nobody answers at this port
        unheard.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{unheard.getsockname()[1]}"
        waiting = subprocess.Popen([os.environ["AUREOLE_BINARY"], "cluster", "render", scene._open.file, "--scheduler", address],
                                   stderr=subprocess.PIPE, text=True, cwd=tmp_path, env=environment)
        try:
            told = [waiting.stderr.readline() for _ in range(2)]  # the first is of the scene
            assert told[1] == f"note: waiting for the scheduler {address}, two minutes at most\n"
        finally:
            waiting.kill()
            waiting.communicate()


def test_slurm_array(scene, alone, tmp_path):
    """tools/slurm_array.sh under a stand-in for sbatch that runs the array on this machine."""
    tools = os.path.join(os.path.dirname(__file__), "..", "..", "tools")
    fake = tmp_path / "bin"
    fake.mkdir()
    (fake / "sbatch").write_text('''#!/bin/bash
# Runs each task of --array=0-N, or the one job after them, and prints a number as sbatch --parsable does. Task $FAIL fails.
array=""
while [[ $1 == --* ]]; do [[ $1 == --array=* ]] && array=${1#--array=}; [[ $1 == --dependency=* && -n $FAIL ]] && { echo 18; exit; }; shift; done
if [[ -n $array ]]; then for ((i = ${array%-*}; i <= ${array#*-}; ++i)); do [[ $i == "$FAIL" ]] || SLURM_ARRAY_TASK_ID=$i "$@" || exit; done; else "$@" || exit; fi >&2
echo 17
''')
    (fake / "sbatch").chmod(0o755)
    environment = {**os.environ, "PATH": f"{fake}:{os.environ['PATH']}", "AUREOLE": os.environ["AUREOLE_BINARY"]}
    command = ["bash", os.path.join(tools, "slurm_array.sh"), scene._open.file, str(tmp_path / "a.exr"), "48", "3", "--partition=long"]
    failed = subprocess.run(command, capture_output=True, text=True, env={**environment, "FAIL": "1"})
    assert failed.returncode == 0 and not (tmp_path / "a.exr").exists()
    assert len(list(tmp_path.glob("a.part*.finished"))) == 2
    times = {file: file.stat().st_mtime_ns for file in tmp_path.glob("a.part*.state")}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert len(times) == 2 and "3 parts are job 17" in done.stdout
    np.testing.assert_allclose(aureole.read_image(tmp_path / "a.exr").array, alone.array, rtol=1e-3)
    assert not list(tmp_path.glob("a.part*"))
    wrong = subprocess.run(["bash", os.path.join(tools, "slurm_array.sh"), "x.xml"], capture_output=True, text=True)
    assert wrong.returncode == 2 and "usage" in wrong.stderr


def test_what_is_missing():
    missing = cluster._Missing(10, [(2, 4), (7, 8)])
    assert missing.count() == 7
    assert [missing.take(2) for _ in range(5)] == [(0, 2), (4, 6), (6, 7), (8, 10), None]


def test_bad_input(scene, client, monkeypatch):
    with pytest.raises(TypeError, match="client: expected"):
        cluster.render(scene, "localhost")
    with pytest.raises(TypeError, match="scene: expected a Scene"):
        cluster.render("scene.xml", client)
    with pytest.raises(TypeError, match=r"table\[0\]: expected a dict"):
        cluster.sweep(scene, client, [3])
    with pytest.raises(aureole.Error, match="part_seconds"):
        cluster.render(scene, client, part_seconds=0)
    with pytest.raises(aureole.Error, match="was given by a program: it cannot be written"):
        cluster.bundle(aureole.load_dict({"type": "scene", "mesh": {"type": "mesh", "vertices": np.eye(3), "faces": [[0, 1, 2]]},
                                          "integrator": {"type": "path"}, "sensor": {"type": "perspective"}}))
    monkeypatch.setattr(_cluster_worker._aureole, "__version__", "0.0.1")
    with pytest.warns(UserWarning, match="is not used: it has aureole"), pytest.raises(aureole.Error, match="no worker of the cluster can render"):
        cluster.render(scene, client, progress=False)
