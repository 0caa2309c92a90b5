# SPDX-License-Identifier: Apache-2.0
"""`aureole.cache`: the folder of kept tables, as the command line has it."""
import os
import subprocess
import sys

import numpy as np
import pytest

import aureole
from aureole import cache

SCENE = """<scene version="3.0.0"><integrator type="path"/>
  <sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="8"/></film></sensor>
  <emitter type="constant"/>
  <shape type="sphere"><bsdf type="null"/><medium name="interior" type="homogeneous"><float name="sigma_t" value="1"/>
    <phase type="mie"><string name="radius" value="RADIUSum"/></phase></medium></shape>
</scene>"""


@pytest.fixture
def folder(tmp_path):
    """A cache of the test's own, and none after it."""
    cache.use(tmp_path / "tables")
    yield tmp_path / "tables"
    cache.use("off")


def load(radius):
    return aureole.load_string(SCENE.replace("RADIUS", str(radius)))


def test_tests_have_no_cache():
    cache.use(None)
    assert os.environ["AUREOLE_CACHE"] == "off" and cache.folder() is None
    with pytest.raises(aureole.Error, match="the cache is off"):
        cache.entries()


def test_tables_are_kept_and_pictures_stay(folder):
    assert cache.folder() == str(folder) and len(cache.entries()) == 0 and cache.size() == 0
    first = aureole.render(load(6), 16, progress=False)
    entries = cache.entries()
    assert len(entries) == 1 and entries.table == ["phase function"] and entries.made_for == ["phase mie"]
    assert cache.size() == os.path.getsize(entries.file[0]) == entries.bytes[0]
    assert entries.seconds[0] > 0.02 and "phase mie" in entries.to_csv() and "1 table," in entries._repr_html_()
    changed = os.stat(entries.file[0]).st_ino
    second = aureole.render(load(6), 16, progress=False)
    assert os.stat(entries.file[0]).st_ino == changed  # read, not written again
    cache.use("off")
    without = aureole.render(load(6), 16, progress=False)
    np.testing.assert_array_equal(first.array, without.array)
    np.testing.assert_array_equal(second.array, without.array)


def test_the_command_line_uses_the_same_tables(folder, tmp_path):
    load(5.5)
    (tmp_path / "scene.xml").write_text(SCENE.replace("RADIUS", "5.5"))
    run = lambda *words: subprocess.run([os.environ["AUREOLE_BINARY"], *words], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    kept = os.stat(cache.entries().file[0]).st_ino
    run("render", "scene.xml", "--spp", "1", "-q", "-o", "a.exr", "--cache", str(folder))
    assert os.stat(cache.entries().file[0]).st_ino == kept and len(cache.entries()) == 1
    assert "1 table," in run("cache", "size", "--cache", str(folder))


def test_the_bound(folder):
    assert cache.limit() == 2**30
    for radius in (5, 5.5, 6):
        load(radius)
    largest = max(cache.entries().bytes)
    assert len(cache.entries()) == 3
    assert cache.limit(2 * largest) == 2 * largest
    assert len(cache.entries()) < 3 and cache.size() <= 2 * largest
    assert cache.limit("500MB") == 500_000_000
    assert cache.clear() > 0 and len(cache.entries()) == 0
    with pytest.raises(aureole.Error, match="no number of bytes"):
        cache.limit("many")
    with pytest.raises(aureole.Error, match="must not be negative"):
        cache.limit(-1)
    with pytest.raises(TypeError, match="bytes: expected a number"):
        cache.limit(1.5)


def test_two_processes_at_once(folder, tmp_path):
    """Both make the table, or one reads the other's; their pictures are the same."""
    program = (f"import aureole, sys; s = aureole.load_string('''{SCENE.replace('RADIUS', '7')}'''); "
               "aureole.render(s, 16, progress=False).save(sys.argv[1])")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "AUREOLE_CACHE": str(folder)}
    running = [subprocess.Popen([sys.executable, "-c", program, str(tmp_path / f"{i}.exr")], env=environment) for i in range(3)]
    assert [p.wait(300) for p in running] == [0, 0, 0]
    pictures = [aureole.read_image(tmp_path / f"{i}.exr").array for i in range(3)]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    np.testing.assert_array_equal(pictures[0], pictures[2])
    assert len(cache.entries()) == 1 and cache.entries().table == ["phase function"]


def test_damaged_tables_are_notes(folder):
    load(6)
    file = cache.entries().file[0]
    content = bytearray(open(file, "rb").read())
    content[len(content) // 2] ^= 1
    open(file, "wb").write(content)
    scene = load(6)
    assert any("computed again" in note for note in scene.notes)
    assert not any("computed again" in note for note in load(6).notes)
