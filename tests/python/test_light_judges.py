# SPDX-License-Identifier: Apache-2.0
"""Other programs judge luminaires: `pyldt` (PyPI eulumdat-py) reads and writes EULUMDAT, Radiance (PyPI pyradiance) computes
illuminances. Both run beside aureole and are never shipped; a test whose judge is not installed is skipped:

    pip install eulumdat-py eulumdat-ugr pyradiance
"""
import importlib.util
import math
import subprocess
import sys

import numpy as np
import pytest

import aureole

pytestmark = pytest.mark.filterwarnings("ignore:set 0 of alternative lamps")

#: A luminaire whose half-planes all differ, and whose flux is 3200 lm from lamps of 4000 lm, in LM-63: length 1.2 m, width 0.3 m.
UNEQUAL = ("IESNA:LM-63-2002\n[MANUFAC] nobody\n[LUMINAIRE] four sides\nTILT=NONE\n1 4000 1 4 5 1 2 0.3 1.2 0\n1 1 36\n0 30 60 90\n0 90 180 270 360\n"
           "900 700 400 20\n900 500 200 10\n900 800 600 50\n900 600 100 0\n900 700 400 20\n")
DOWN = '<transform name="to_world"><rotate x="1" angle="180"/></transform>'


@pytest.fixture
def files(repository, tmp_path):
    """Luminaires of both formats."""
    (tmp_path / "unequal.ies").write_text(UNEQUAL)
    lamps = repository / "tests/references/scenes/luminaires"
    return [tmp_path / "unequal.ies", lamps / "downlight.ies", lamps / "asymmetric.ies", lamps / "batten.ldt", repository / "scenes/light/trough.ldt"]


def candela(data, c):
    """Intensities [cd] of the half-plane c [degrees] that a result holds."""
    if len(data.azimuths) == 1:
        return data.candela[0]
    found = np.flatnonzero(np.abs((data.azimuths - c + 180) % 360 - 180) < 1e-6)
    assert len(found) > 0, c
    return data.candela[found[0]]


def flux_by_zones(c, gamma, cd):
    """Flux of intensities [cd] over C and gamma [degrees] by the trapezoid rule over C and exact zones of linear intensities."""
    c, gamma = np.radians(np.append(c, 360 + c[0])), np.radians(gamma)
    mean = (0.5 * (cd + np.roll(cd, -1, axis=0)) * np.diff(c)[:, None]).sum(axis=0)
    t = [np.linspace(a, b, 400) for a, b in zip(gamma[:-1], gamma[1:])]
    return sum(np.trapezoid(np.interp(x, gamma, mean) * np.sin(x), x) for x in t)


def test_eulumdat_that_is_written(files, tmp_path):
    pyldt = pytest.importorskip("pyldt", reason="the judge of EULUMDAT files is missing: pip install eulumdat-py")
    for file in files:
        ours = aureole.goniophotometer(file)
        # C of EULUMDAT is C of LM-63 less 90 degrees: its plane C = 0 lies across the luminaire.
        turn = 90 if file.suffix == ".ies" else 0
        ours.save(tmp_path / "a.ldt")
        theirs = pyldt.LdtReader.read(tmp_path / "a.ldt")
        head = theirs.header
        per_klm = np.array(theirs.intensities)
        assert per_klm.shape == (head.mc, head.ng) == (len(head.c_angles), len(head.g_angles))
        total = head.lamp_flux[0]
        for row, c in zip(per_klm, head.c_angles):
            expected = candela(ours, c + turn)
            np.testing.assert_allclose(row * total / 1000, expected, atol=2e-5 * ours.peak, err_msg=f"{file.name} C {c}")
        assert [head.length_lum_area, head.width_lum_area] == pytest.approx([1000 * ours.opening[0], 1000 * ours.opening[1]], abs=0.5) or head.width_lum_area == 0
        # The flux by the judge's table, and its light output ratio.
        flux = flux_by_zones(head.c_angles, head.g_angles, per_klm * total / 1000)
        assert ours.flux == pytest.approx(flux, rel=1e-3), file.name
        if ours.lamp_flux > 0:
            assert head.lorl == pytest.approx(100 * ours.flux / total, abs=0.01)
        # Their file of what they have read comes back.
        pyldt.LdtWriter.write(theirs, tmp_path / "b.ldt", overwrite=True)
        back = aureole.goniophotometer(tmp_path / "b.ldt")
        for c in head.c_angles:
            np.testing.assert_allclose(candela(back, c), candela(ours, c + turn), atol=1e-3 * ours.peak, err_msg=f"{file.name} C {c}")


@pytest.mark.parametrize("symmetry", [0, 1, 2, 3, 4])
def test_eulumdat_of_all_symmetries(tmp_path, symmetry):
    pyldt = pytest.importorskip("pyldt", reason="the judge of EULUMDAT files is missing: pip install eulumdat-py")
    gamma = list(range(0, 181, 15))
    c = [0.0] if symmetry == 1 else [30.0 * k for k in range(12)]

    def intensity(azimuth, polar):
        a = math.radians(azimuth)
        shapes = (1 + 0.3 * math.cos(a) + 0.2 * math.sin(2 * a + 0.5), 1, 1 + 0.3 * math.cos(a), 1 + 0.3 * math.sin(a), 1 + 0.4 * math.cos(2 * a))
        return round(300 * shapes[symmetry] * (0.2 + math.sin(math.radians(polar)) ** 2) + polar, 3)

    head = pyldt.LdtHeader(company="nobody", ityp=3 if symmetry != 1 else 1, isym=symmetry, mc=1 if symmetry == 1 else 12, dc=0 if symmetry == 1 else 30, ng=13, dg=15, luminaire_name="symmetric",
                           length=1200, width=300, height=80, length_lum_area=1100, width_lum_area=200, dff=50, lorl=100, conv_factor=1, n_sets=1, num_lamps=[2], lamp_types=["T5"],
                           lamp_flux=[2500.0], lamp_cct=["4000"], lamp_cri=["80"], lamp_watt=[50.0], direct_ratios=[0.5] * 10, c_angles=c, g_angles=[float(g) for g in gamma])
    table = [[intensity(a, g) for g in gamma] for a in c]
    pyldt.LdtWriter.write(pyldt.Ldt(header=head, intensities=table), tmp_path / "s.ldt", overwrite=True)
    ours = aureole.goniophotometer(tmp_path / "s.ldt")
    for azimuth in [30.0 * k for k in range(12)]:
        expected = [2.5 * intensity(0 if symmetry == 1 else azimuth, g) for g in gamma]
        np.testing.assert_allclose(candela(ours, azimuth), expected, rtol=1e-3, err_msg=f"C {azimuth}")
    assert ours.lamp_flux == 2500 and ours.opening[:2] == (1.1, 0.2)


def test_tables_of_ugr(repository, tmp_path):
    """`eulumdat-ugr` (PyPI) has the transfer factors, multipliers and position index of CIE 117 and CIE 190 as tables."""
    pytest.importorskip("pyldt", reason="the reader of the judge of UGR is missing: pip install eulumdat-py")
    judge = pytest.importorskip("eulumdat_ugr", reason="the judge of UGR is missing: pip install eulumdat-ugr")
    from pyldt import LdtReader

    panel = "IESNA:LM-63-2002\nTILT=NONE\n1 4000 1 10 3 1 2 {} 0\n1 1 36\n0 10 20 30 40 50 60 70 80 90\n0 45 90\n"
    halves = ("900 890 850 790 690 540 350 170 60 0\n", "900 885 830 750 640 480 290 130 40 0\n", "900 880 810 720 590 420 240 100 30 0\n")
    for opening in ("0.3 1.2", "0.6 0.6", "-0.2 -0.2"):
        (tmp_path / "a.ies").write_text(panel.format(opening) + "".join(halves if opening[0] != "-" else halves[:1] * 3))
        lamp = aureole.goniophotometer(tmp_path / "a.ies")
        lamp.save(tmp_path / "a.ldt")
        for spacing in (0.25, 1.0):
            found = aureole.ugr(lamp, spacing=spacing)
            theirs = judge.UgrCalculator.compute(LdtReader.read(tmp_path / "a.ldt"), spacing).values
            difference = np.concatenate([found.crosswise, found.endwise], axis=1) - theirs
            # The formula of the position index and exact direct fluxes instead of tables: record 0201.
            assert np.abs(difference).max() < 0.5 and abs(difference.mean()) < 0.3, (opening, spacing, difference)


def lux(file, points, opening, spp):
    """Illuminances [lx] of horizontal receivers that face up, of a luminaire at the origin that hangs face down."""
    choice = '<string name="opening" value="point"/>' if opening == "point" else ""
    out = []
    for x, y, z in points:
        scene = aureole.load_string(f"""<scene version="3.0.0"><integrator type="path"/><sensor type="powermap"><string name="measure" value="irradiance"/>
          <transform name="to_world"><scale value="0.0001"/><translate x="{x}" y="{y}" z="{z}"/></transform><film type="hdrfilm"><integer name="width" value="1"/>
          <integer name="height" value="1"/><string name="quantity" value="illuminance"/><rfilter type="box"/></film></sensor>
          <emitter type="photometric"><string name="filename" value="{file}"/>{choice}{DOWN}</emitter></scene>""")
        out.append(float(aureole.render(scene, spp=spp, progress=False).array.mean()))
    return np.array(out)


def test_illuminances_of_radiance(repository, files, tmp_path):
    if importlib.util.find_spec("pyradiance") is None:
        pytest.skip("the judge of illuminances is missing: pip install pyradiance")
    script = repository / "tests/parameter/luminaire/make_radiance_illuminances.py"
    # Points and openings, of LM-63 as it is, and of EULUMDAT and a file with TILT by way of aureole's conversion.
    for file in (files[1], files[3]):
        aureole.goniophotometer(file).save(tmp_path / (file.stem + ".ies"))
    for opening in ("point", "file"):
        out = tmp_path / f"{opening}.csv"
        done = subprocess.run([sys.executable, script, "--opening", opening, "-o", out, files[0], tmp_path / "downlight.ies", tmp_path / "batten.ies"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        rows = [line.split(",") for line in out.read_text().split()[1:]]
        assert len(rows) == 24
        for file in (files[0], files[1], files[3]):
            own = [r for r in rows if r[0].split(".")[0] == file.stem]
            assert len(own) == 8
            found = lux(file, [r[1:4] for r in own], opening, 256 if opening == "point" else 16384)
            expected = np.array([float(r[4]) for r in own])
            # Radiance takes the light of a luminous box from its faces, aureole from its volume: 20 mm of 2 m here.
            tolerance = 1e-3 if opening == "point" else 3e-3 if file.suffix == ".ies" else 1.5e-2
            np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance, err_msg=f"{file.name} {opening}")
