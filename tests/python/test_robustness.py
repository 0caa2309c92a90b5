# SPDX-License-Identifier: Apache-2.0
"""Threads, signals, the end of the program, lifetimes, memory, and the same bits as the command line's."""
import copy
import gc
import multiprocessing
import os
import pickle
import resource
import signal
import subprocess
import sys
import textwrap
import threading
import time
import tracemalloc
import warnings
from pathlib import Path

import numpy as np
import pytest

import aureole
from aureole import _aureole, optics
from effort import effort
from endless_scene import ENDLESS, Lambert, make


def program(text, timeout=60):
    """Runs a program that has the names of endless_scene.py; its exit code and what it said."""
    here = str(Path(__file__).parent)
    code = f"import sys; sys.path.insert(0, {here!r})\nfrom endless_scene import *\n" + textwrap.dedent(text)
    done = subprocess.run([sys.executable, "-X", "faulthandler", "-c", code], capture_output=True, text=True, timeout=timeout)
    return done.returncode, done.stdout, done.stderr


# ---------------------------------------------------------------- threads


def test_reading_while_another_thread_changes_the_scene():
    scene, problems = make(), []

    def change():
        try:
            for i in range(60):
                scene["ball.bsdf"] = {"type": "plastic" if i % 2 else "diffuse"}
                scene["sensor.fov"] = 30.0 + i % 7
        except Exception as e:  # noqa: BLE001
            problems.append(e)

    threads = [threading.Thread(target=change) for _ in range(2)]
    for t in threads:
        t.start()
    reads = 0
    while any(t.is_alive() for t in threads):
        assert "ball.bsdf" in scene.paths()
        assert 30 <= scene["sensor.fov"] <= 40
        assert scene.size == (16, 16) and scene.bounds.shape == (2, 3) and scene.hash and scene.notes is not None
        assert isinstance(scene["ball.bsdf"], aureole.Bsdf)
        reads += 1
    assert not problems and reads > 3


def test_a_destructor_amid_a_change_gets_an_error():
    """An object that a change drops may run Python code during the change."""
    scene, seen = make(bsdf=Lambert()), []

    class Nosy(Lambert):
        def __del__(self):
            try:
                seen.append(scene["sensor.fov"])
            except aureole.Error as e:
                seen.append(str(e))

    scene["ball.bsdf"] = Nosy()
    assert isinstance(scene["ball.bsdf"], aureole.Bsdf)
    scene["ball.bsdf"] = {"type": "diffuse"}
    scene["sensor.fov"] = 31.0
    gc.collect()
    assert len(seen) == 1 and (seen[0] == pytest.approx(40.0) or seen[0] == 31.0 or "being changed" in seen[0])


@pytest.mark.parametrize("bsdf", [None, Lambert()], ids=["compiled", "python"])
def test_a_progress_function_that_raises(bsdf):
    """Threads that need Python's lock to end must get it."""
    def report(*_):
        raise KeyError("mine")

    start = time.monotonic()
    with pytest.raises(KeyError, match="mine"):
        aureole.render(make(ENDLESS, bsdf=bsdf), progress=report)
    assert time.monotonic() - start < 30


def test_rendering_amid_a_render_of_the_same_scene():
    scene, inner = make(4096, 32), []

    def report(*_):
        if not inner:
            inner.append(aureole.render(scene, spp=16, progress=False).array.copy())

    aureole.render(scene, spp=2048, progress=report)
    assert inner and np.array_equal(inner[0], aureole.render(scene, spp=16, progress=False).array)


def test_changing_a_scene_amid_its_render():
    scene, before, seen = make(4096, 32), make(4096, 32), []

    def report(*_):
        scene.update({"ball.bsdf.alpha": 0.3, "ball.radius": 0.5})
        seen.append(scene["ball.bsdf.alpha"])

    # The picture is that of the scene as it was.
    image = aureole.render(scene, spp=2048, progress=report)
    assert seen and set(seen) == {0.3}
    assert np.array_equal(image.array, aureole.render(before, spp=2048, progress=False).array)
    before.update({"ball.bsdf.alpha": 0.3, "ball.radius": 0.5})
    assert np.array_equal(*(aureole.render(s, spp=16, progress=False).array for s in (scene, before)))


def test_an_exception_of_a_bsdf_written_in_python():
    class Broken(Lambert):
        def sample(self, wi, wavelength, u):
            raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        aureole.render(make(ENDLESS, bsdf=Broken()), progress=False)


# ---------------------------------------------------------------- Ctrl-C


def interrupted_after(seconds, function, times=1):
    """Calls the function; another thread sends SIGINT meanwhile. Returns result or exception, and the time since the signal."""
    sent = []

    def send():
        time.sleep(seconds)
        for _ in range(times):
            sent.append(time.monotonic())
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
            time.sleep(0.02)

    thread = threading.Thread(target=send)
    thread.start()
    try:
        try:
            result = function()
        except KeyboardInterrupt as e:
            result = e
        took = time.monotonic() - sent[0] if sent else 0.0
    finally:
        thread.join()
    return result, took


def test_ctrl_c_keeps_what_is_done():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = make(ENDLESS)
        image, took = interrupted_after(0.2, lambda: aureole.render(scene, progress=False))
    assert isinstance(image, aureole.Image) and not image.complete and took < 10
    assert [w.category for w in caught] == [aureole.InterruptedWarning]


def test_a_second_ctrl_c_raises():
    class Slow(Lambert):
        def eval(self, wi, wo, wavelength):
            time.sleep(0.002)
            return super().eval(wi, wo, wavelength)

    scene = make(ENDLESS, 8, Slow())
    result, _ = interrupted_after(0.2, lambda: aureole.render(scene, progress=False), times=20)
    assert isinstance(result, KeyboardInterrupt)


@pytest.mark.parametrize("work", [
    lambda: optics.hard_discs(30000, 0.6),
    lambda: optics.hard_discs(10000, 0.6, radius=np.linspace(1, 2, 10000)),
    lambda: optics.mie(np.full(10**6, 9e4), 1.5),
    lambda: optics.StructureFactor.simulated(0.65, discs=4000, snapshots=1000),
    lambda: aureole.check(aureole.load_dict({"type": "roughconductor", "alpha": 0.01}), samples=10**8),
    lambda: aureole.load_dict({"type": "roughplastic"}).albedo(0.3, 550, samples=10**8),
    lambda: aureole.load_dict({"type": "roughplastic"}).eval([0, 0, 1], np.broadcast_to([0, 0.6, 0.8], (2**28, 3)), 550),
], ids=["hard_discs", "mixture", "mie", "simulated", "check", "albedo", "eval"])
def test_ctrl_c_during_long_work(work):
    result, took = interrupted_after(0.2, work)
    assert isinstance(result, KeyboardInterrupt) and took < 10


# ---------------------------------------------------------------- the end of the program, and children of it


@pytest.mark.parametrize("work", [
    "aureole.render(make(ENDLESS), progress=False)",
    "aureole.render(make(ENDLESS, bsdf=Lambert()), progress=False)",
    "aureole.render(make(ENDLESS, bsdf=Inner()), progress=False)",
    "optics.mie(np.full(10**6, 9e4), 1.5)",
    "optics.hard_discs(30000, 0.6)",
    "aureole.check(aureole.load_dict({'type': 'roughconductor', 'alpha': 0.01}), samples=10**8)",
    "aureole.load_dict({'type': 'roughplastic'}).albedo(0.3, 550, samples=10**8)",
    "change()",
], ids=["render", "python-bsdf", "python-bsdf-that-calls", "mie", "hard_discs", "check", "albedo", "set"])
def test_the_program_may_end_amid_work_of_a_daemon_thread(work):
    start = time.monotonic()
    code, out, err = program(f"""
        class Inner(Lambert):  # work of the module within a callback must come back, or the end of the program waits in vain
            inner = aureole.load_dict({{"type": "diffuse"}})

            def eval(self, wi, wo, wavelength):
                return self.inner.eval(wi, wo, wavelength)

        def change():
            scene = make()
            while True:
                scene["sensor.fov"] = 30 + np.random.rand()
        threading.Thread(target=lambda: {work}, daemon=True).start()
        time.sleep(0.2)
        print("end")
        sys.exit(5)
    """)
    assert (code, out) == (5, "end\n"), err
    assert "nanobind" not in err
    assert time.monotonic() - start < 9  # 10 s is how long the end waits for work that does not stop


def test_nothing_is_left_at_the_end():
    """nanobind counts instances, types and functions that nobody freed."""
    code, _, err = program("""
        scene = make(1, 8, bsdf=Lambert())
        image = aureole.render(scene, progress=False)
        kept = [image.array, scene["ball.bsdf"], optics.circle(1e-6), optics.StructureFactor.percus_yevick(0.3), aureole.check(scene["ball.bsdf"], samples=1000)]
        try:
            aureole.load_string("<bsdf type='diffus'/>")
        except aureole.Error as e:
            error = e
    """)
    assert code == 0 and not err, err


def _digest(queue=None):
    array = aureole.render(make(32, 48), progress=False).array
    if queue is not None:
        queue.put(array.tobytes())
    return array.tobytes()


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_children_of_the_process_render(method):
    expected = _digest()  # threads exist before the fork
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        child = context.Process(target=_digest, args=(queue,))
        child.start()
    assert queue.get(timeout=60) == expected
    child.join(60)
    assert child.exitcode == 0


def test_a_child_renders_whatever_its_parent_did_at_the_fork():
    code, out, err = program("""
        threading.Thread(target=lambda: aureole.render(make(ENDLESS), progress=False), daemon=True).start()
        time.sleep(0.2)
        for _ in range(3):
            child = os.fork()
            if child == 0:
                signal.alarm(30)
                aureole.render(make(32, 48), progress=False)
                optics.mie(np.full(40, 5e4), 1.5)
                os._exit(7)
            print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """)
    assert (code, out) == (0, "7\n" * 3), err


def test_what_a_change_drops_is_freed():
    """Arrays and BSDFs that a program gave are kept by the scene as long as it shows them."""
    import weakref

    scene, kept = make(), []
    for _ in range(5):
        bsdf = Lambert()
        kept.append(weakref.ref(bsdf))
        scene["ball.bsdf"] = bsdf
    del bsdf
    scene["sensor.fov"] = 33.0
    gc.collect()
    assert [k() is not None for k in kept] == [False] * 4 + [True]


def test_a_fork_amid_a_render_of_another_thread_ends():
    code, out, err = program("""
        threading.Thread(target=lambda: aureole.render(make(ENDLESS), progress=False), daemon=True).start()
        time.sleep(0.2)
        child = os.fork()
        if child == 0:
            start = time.monotonic()
            import atexit
            atexit._run_exitfuncs()
            os._exit(7 if time.monotonic() - start < 5 else 8)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """)
    assert (code, out) == (0, "7\n"), err


# ---------------------------------------------------------------- lifetimes


def test_what_comes_from_a_scene_outlives_it():
    scene = make(size=8)
    image = aureole.render(scene, progress=False)
    bsdf, film, views = scene["ball.bsdf"], scene["sensor.film"], [image.array, image["R"], image.rgb]
    expected = [v.copy() for v in views]
    value = bsdf.eval([0, 0, 1], [0, 0.6, 0.8], 550)
    del scene, image
    gc.collect()
    clutter = [np.full(2**16, np.nan) for _ in range(20)]
    assert bsdf.eval([0, 0, 1], [0, 0.6, 0.8], 550) == value and film.id is not None
    assert all(np.array_equal(a, b) for a, b in zip(views, expected))
    del clutter


def test_views_are_read_only():
    for view in (lambda i: i.array, lambda i: i.rgb, lambda i: i["R"]):
        array = view(aureole.Image(np.ones((2, 3, 3))))
        with pytest.raises(ValueError):
            array[...] = 2
        with pytest.raises(ValueError):
            array.flags.writeable = True


@pytest.mark.parametrize("thing", [
    lambda: make(), lambda: aureole.load_dict({"type": "diffuse"}), lambda: optics.circle(1e-6),
    lambda: optics.StructureFactor.percus_yevick(0.3), lambda: aureole.render(make(), spp=1, progress=False),
], ids=["scene", "bsdf", "aperture", "factor", "image"])
def test_copies_and_pickles(thing):
    """Either right, or a TypeError that says what cannot be done."""
    for act in (copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))):
        instance = thing()
        try:
            result = act(instance)
        except TypeError as e:
            assert "pickle" in str(e) or "copy" in str(e)
        else:
            assert type(result) is type(instance)
            repr(result)


def test_pickled_pictures_are_whole(scene_file):
    scene = aureole.load_file(scene_file)
    image = aureole.render(scene, spp=16, replicates=2, progress=False)
    for other in (pickle.loads(pickle.dumps(image)), copy.deepcopy(image)):
        assert np.array_equal(other.array, image.array) and np.array_equal(other.variance, image.variance)
        assert np.array_equal(other.rgb, image.rgb) and other.info == image.info and repr(other) == repr(image)
        more = aureole.render(scene, spp=32, replicates=2, start=other, progress=False)
        assert np.array_equal(more.array, aureole.render(scene, spp=32, replicates=2, progress=False).array)
    array = aureole.Image(np.arange(12).reshape(2, 2, 3))
    assert np.array_equal(pickle.loads(pickle.dumps(array)).array, array.array)
    width, height, *rest = array._picture.__getstate__()
    with pytest.raises(aureole.Error, match="pickled picture"):
        _aureole.Picture.__new__(_aureole.Picture).__setstate__((width, height + 1, *rest))


def test_pickling_says_what_to_do():
    with pytest.raises(TypeError, match="Bsdf cannot be pickled: pass the dictionary or the XML"):
        pickle.dumps(aureole.load_dict({"type": "diffuse"}))
    with pytest.raises(TypeError, match="Scene cannot be pickled or copied: pass the file"):
        pickle.dumps(make())


def test_names_that_are_not_utf8(tmp_path):
    file = tmp_path / "a.exr"
    aureole.Image(np.ones((4, 4, 3))).save(file)
    content = file.read_bytes()
    at = content.index(b"channels\0chlist\0") + len(b"channels\0chlist\0") + 4
    file.write_bytes(content[:at] + b"\xff" + content[at + 1:])
    with pytest.raises(aureole.Error, match="the name of the channel .* is not UTF-8"):
        aureole.read_image(file)
    scene = os.fsencode(tmp_path) + b"/\xff.xml"
    with open(scene, "w") as f:
        f.write(make().xml())
    loaded = aureole.load_file(os.fsdecode(scene))
    assert repr(loaded)
    assert aureole.render(loaded, spp=1, progress=False).info["scene"] == os.fsdecode(b"\xff.xml")


def test_pipes_are_errors(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for read in (aureole.read_image, aureole.read_vol, aureole.load_file, aureole.pigment.Palette.load):
        with pytest.raises(aureole.Error, match="not a regular file but a pipe"):
            read(pipe)
    os.mkfifo(tmp_path / "pipe.exr")
    for write in (lambda: aureole.write_vol(pipe, np.ones((1, 1, 1))), lambda: aureole.Image(np.ones((1, 1))).save(tmp_path / "pipe.exr")):
        with pytest.raises(aureole.Error, match="it is a pipe"):
            write()


def test_objects_that_were_not_made():
    """Python can leave out __init__."""
    for kind in (_aureole.Bsdf, _aureole.OpenScene, _aureole.Picture, _aureole.Array, _aureole.ApertureShape):
        instance = kind.__new__(kind)
        for name in dir(kind):
            if not name.startswith("_") or name == "__repr__":
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    try:
                        value = getattr(instance, name)
                        if callable(value):
                            value()
                    except (TypeError, RuntimeError):
                        pass


# ---------------------------------------------------------------- memory


def _traced():
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


def _rss():
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize()


def test_memory_stays():
    def round_():
        scene = make(1, 32)
        for alpha in (0.1, 0.4):
            scene["ball.bsdf.alpha"] = alpha
        scene["ball.bsdf"] = Lambert()
        scene["ball.bsdf"] = {"type": "diffuse", "reflectance": {"type": "bitmap", "data": np.ones((64, 64, 3)), "raw": True}}
        image = aureole.render(scene, spp=1, progress=False)
        image.rgb, image.tonemap(), image._repr_png_(), image["R"]
        for wrong in ({"ball.bsdf.alpha": "x"}, {"nothing.here": 1}):
            with pytest.raises(aureole.Error):
                scene.update(wrong)
        scene["ball.bsdf"].eval([0, 0, 1], [0, 0.6, 0.8], 550)
        optics.mie([1, 2], 1.5), optics.circle(1e-6).transform([[0, 1]])

    for _ in range(20):
        round_()
    rounds = effort(50, 200)

    def growth():
        before = _rss()
        for _ in range(rounds):
            round_()
        return _rss() - before

    # A leaked picture of 32 x 32 pixels is 12 KiB, a scene far more. Leaks show each time; memory that an allocator keeps, once.
    assert any(growth() < rounds * 12 * 1024 for _ in range(3))
    # Apart from the above: the records of tracemalloc are memory, too.
    tracemalloc.start()
    try:
        round_()
        before = _traced()
        for _ in range(rounds):
            round_()
        assert _traced() - before < rounds * 1024  # 1 KiB a round
    finally:
        tracemalloc.stop()


# ---------------------------------------------------------------- the command line


XML = """<scene version="3.0.0"><default name="grey" value="0.3"/><integrator type="path"/><sensor type="perspective"><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform><film type="hdrfilm"><integer name="width" value="24"/>
<integer name="height" value="16"/></film><sampler type="sobol"><integer name="sample_count" value="32"/></sampler></sensor>
<shape type="sphere"><bsdf type="roughconductor"><float name="alpha" value="$grey"/></bsdf></shape><emitter type="constant"/></scene>"""


@pytest.fixture(scope="session")
def binary():
    found = os.environ.get("AUREOLE_BINARY")
    path = Path(found) if found else Path(aureole.__file__).resolve().parents[2] / "bin" / "aureole"
    if not path.is_file():
        path = Path(os.path.abspath(_aureole.__file__)).parents[2] / "bin" / "aureole"
    if not path.is_file():
        pytest.skip(f"there is no program {path}: build it or set AUREOLE_BINARY")
    return str(path)


def _by_command(binary, scene, out, *options):
    subprocess.run([binary, "render", str(scene), "-o", str(out), "--restart", *options], check=True, capture_output=True, timeout=300)
    return aureole.read_image(out)


def _same_bits(rendered, stored):
    half = rendered.astype(np.float16).astype(np.float32)
    return np.array_equal(rendered, stored, equal_nan=True) or np.array_equal(half, stored, equal_nan=True)


def _pixels(path):
    image = aureole.read_image(path)
    return {name: image[name].tobytes() for name in image._names}


@pytest.fixture(params=["own", "bsdf-roughdielectric.xml", "emitter-spot.xml"])
def scene_file(request, tmp_path, repository):
    if request.param == "own":
        (tmp_path / "own.xml").write_text(XML)
        return tmp_path / "own.xml"
    path = repository / "tests" / "references" / "scenes" / request.param
    assert path.is_file()
    return path


@pytest.mark.parametrize("options, arguments", [
    (["--spp", "16"], {"spp": 16}), (["--spp", "32", "--seed", "7"], {"spp": 32, "seed": 7}),
    (["--spp", "16", "--replicates", "3"], {"spp": 16, "replicates": 3}),
    (["--spp", "16", "--adaptive", "display"], {"spp": 16, "adaptive": "display"}),
], ids=["spp", "seed", "replicates", "adaptive"])
def test_the_bits_of_the_command_line(binary, scene_file, tmp_path, options, arguments):
    expected = _by_command(binary, scene_file, tmp_path / "command.exr", *options, "--threads", "2")
    scene = aureole.load_file(scene_file)
    pictures = [aureole.render(scene, threads=threads, progress=False, **arguments) for threads in (1, 2)]
    assert np.array_equal(pictures[0].array, pictures[1].array, equal_nan=True)
    image = pictures[0]
    # Films store half precision where the scene does not say float32.
    assert _same_bits(image.array, expected.array)
    assert image.channels == expected.channels and (image.variance is None) == (expected.variance is None)
    if image.variance is not None:
        assert np.array_equal(image.variance, pictures[1].variance) and _same_bits(image.variance, expected.variance)
    image.save(tmp_path / "python.exr")
    assert _pixels(tmp_path / "python.exr") == _pixels(tmp_path / "command.exr")
    image.save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "command.png").read_bytes()


def test_the_bits_of_the_command_line_with_definitions(binary, tmp_path):
    (tmp_path / "own.xml").write_text(XML)
    expected = _by_command(binary, tmp_path / "own.xml", tmp_path / "a.exr", "-D", "grey=0.7", "--spp", "16").array
    image = aureole.render(aureole.load_file(tmp_path / "own.xml", grey=0.7), spp=16, progress=False)
    assert _same_bits(image.array, expected)
    assert not _same_bits(aureole.render(aureole.load_file(tmp_path / "own.xml"), spp=16, progress=False).array, expected)


def test_refinements_end_at_the_picture(scene_file):
    scene = aureole.load_file(scene_file)
    *_, last = aureole.render_iter(scene, spp=64)
    assert np.array_equal(last.array, aureole.render(scene, spp=64, progress=False).array, equal_nan=True)
