#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write src/aureole/spectrum/data/{cie_1931_observer,cie_1964_observer,cie_1951_scotopic,cie_1988_modified_photopic,illuminants}.inc from the colour-science package.

    python tools/make_spectral_tables.py [output directory]

Needs colour-science 0.4 (PyPI), whose tables follow the CIE publications named below. The output is the same, byte
for byte, for the same tables; the provenance of each is printed. Two families are carried on past where
colour-science ends (780 nm), by their definitions, because CIE publishes them to 830 nm:
  - A: Planck's law at 2848 K with c2 = 1.435e-2 m K, normalised to 100 at 560 nm (CIE 15:2004, section 3.1);
  - D50, D55, D65, D75: S0 + M1 S1 + M2 S2 with M1, M2 rounded to three decimals (CIE 15:2004, section 3.1 and
    appendix C); the script checks that this gives the published values up to 780 nm to 0.001.
"""
import pathlib
import sys
import warnings

warnings.filterwarnings("ignore")
import numpy as np  # noqa: E402
import colour  # noqa: E402

CIE_2004 = "CIE 15:2004, Colorimetry, 3rd edition, appendix T"
CIE_2018 = "CIE 015:2018, Colorimetry, 4th edition"
ROOT = pathlib.Path(__file__).resolve().parent.parent
LICENCE = "// SPDX-License-Identifier: Apache-2.0\n"
MADE_BY = "// Made by tools/make_spectral_tables.py; do not edit.\n"


def wrapped(values):
    """The numbers as C++ initialisers, shortest decimals that read back the same, in lines of at most 110."""
    lines, line = [], ""
    for v in values:
        text = repr(float(v)).removesuffix(".0") + ","
        if len(line) + 1 + len(text) > 110:
            lines.append(line)
            line = ""
        line += (" " if line else "    ") + text
    return "\n".join(lines + [line])


def daylight(name, values):
    """A D-series illuminant from 300 to 830 nm; `values` are the published ones from 300 to 780 nm."""
    t = {"D50": 5000, "D55": 5500, "D65": 6500, "D75": 7500}[name] * 1.4388 / 1.4380
    if t <= 7000:
        x = -4.6070e9 / t**3 + 2.9678e6 / t**2 + 0.09911e3 / t + 0.244063
    else:
        x = -2.0064e9 / t**3 + 1.9018e6 / t**2 + 0.24748e3 / t + 0.237040
    y = -3.000 * x**2 + 2.870 * x - 0.275
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = round((-1.3515 - 1.7703 * x + 5.9114 * y) / m, 3)
    m2 = round((0.0300 - 31.4424 * x + 30.0717 * y) / m, 3)
    s0, s1, s2 = (
        colour.colorimetry.SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES[k].values for k in ("S0", "S1", "S2"))
    computed = s0 + m1 * s1 + m2 * s2
    assert np.max(np.abs(computed[: len(values)] - values)) < 1e-3, name
    return np.concatenate([values, np.round(computed[len(values):], 4)])


def planckian_a(values):
    """Illuminant A from 300 to 830 nm; `values` are the published ones from 300 to 780 nm."""
    nm = 300.0 + 5.0 * np.arange(107)
    power = 100 * (560 / nm) ** 5 * np.expm1(1.435e7 / (2848 * 560)) / np.expm1(1.435e7 / (2848 * nm))
    assert np.max(np.abs(power[: len(values)] / values - 1)) < 1e-4
    return np.concatenate([values, np.round(power[len(values):], 3)])


def illuminant_names():
    fluorescent = [f"FL{i}" for i in range(1, 13)] + [f"FL3.{i}" for i in range(1, 16)]
    leds = [f"LED-B{i}" for i in range(1, 6)] + ["LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"]
    lamps = [f"HP{i}" for i in range(1, 6)]
    daylights = ["D50", "D55", "D60", "D65", "D75", "ID50", "ID65"]
    return ["A", "B", "C", "E"] + daylights + fluorescent + lamps + leds


def source_of(name):
    if name == "E":
        return "equal energy by definition"
    if name == "D60":
        return CIE_2004 + ", D-series formula"
    return CIE_2018 if name.startswith(("LED", "ID")) else CIE_2004


def write(path, text):
    path.write_text(text, encoding="utf-8", newline="\n")
    print(f"wrote {path.name}: {len(text)} bytes")


def write_observer(directory, year, degrees, standard, name):
    cmfs = colour.MSDS_CMFS[f"CIE {year} {degrees} Degree Standard Observer"]
    assert np.array_equal(cmfs.wavelengths, np.arange(360, 831))
    source = f"CIE {year} {degrees}-degree observer, 360-830 nm in steps of 1 nm: {standard}"
    text = LICENCE + MADE_BY + f"// {source}.\n"
    for i, axis in enumerate("XYZ"):
        text += f"constexpr double {name}{axis}[471] = {{\n{wrapped(cmfs.values[:, i])}\n}};\n"
    write(directory / f"cie_{year}_observer.inc", text)
    print(" ", source)


def write_scotopic(directory):
    name = "CIE 1951 scotopic luminous efficiency, {:.0f}-{:.0f} nm in steps of 1 nm: CIE 018:2019 / ISO 23539"
    sd = colour.colorimetry.SDS_LEFS_SCOTOPIC["CIE 1951 Scotopic Standard Observer"]
    first, last = sd.wavelengths[0], sd.wavelengths[-1]
    assert np.array_equal(sd.wavelengths, np.arange(first, last + 1))
    source = name.format(first, last)
    text = LICENCE + MADE_BY + f"// {source}.\nconstexpr double kScotopicStart = {first:.0f};\n"
    text += f"constexpr double kScotopic[{len(sd.values)}] = {{\n{wrapped(sd.values)}\n}};\n"
    write(directory / "cie_1951_scotopic.inc", text)
    print(" ", source)


def write_modified_photopic(directory):
    sd = colour.colorimetry.SDS_LEFS_PHOTOPIC["Judd-Vos Modified CIE 1978 Photopic Standard Observer"]
    first, last = sd.wavelengths[0], sd.wavelengths[-1]
    assert np.array_equal(sd.wavelengths, np.arange(first, last + 1))
    source = f"V_M by Judd (1951) and Vos (1978), {first:.0f}-{last:.0f} nm in steps of 1 nm: CIE 86-1990"
    text = LICENCE + MADE_BY + f"// {source}.\nconstexpr double kModifiedPhotopicStart = {first:.0f};\n"
    text += f"constexpr double kModifiedPhotopic[{len(sd.values)}] = {{\n{wrapped(sd.values)}\n}};\n"
    write(directory / "cie_1988_modified_photopic.inc", text)
    print(" ", source)


def write_illuminants(directory):
    text = LICENCE + MADE_BY + "// Relative spectral power, as published. Sources stand above each table.\n"
    rows = []
    for index, name in enumerate(illuminant_names()):
        sd = colour.SDS_ILLUMINANTS[name]
        values, start, step = sd.values, float(sd.wavelengths[0]), float(sd.shape.interval)
        if name in ("D50", "D55", "D65", "D75"):
            values = daylight(name, values)
        elif name == "A":
            values = planckian_a(values)
        end = start + step * (len(values) - 1)
        assert step == 5.0 and np.allclose(sd.wavelengths, start + step * np.arange(len(sd.wavelengths)))
        note = f"{name}: {source_of(name)}; {start:.0f}-{end:.0f} nm"
        text += f"// {note}.\nconstexpr double kIlluminant{index}[] = {{\n{wrapped(values)}\n}};\n"
        rows.append(f'    {{"{name}", {start:.0f}, kIlluminant{index}}},')
        print(" ", note)
    text += "constexpr IlluminantRecord kIlluminants[] = {\n" + "\n".join(rows) + "\n};\n"
    write(directory / "illuminants.inc", text)


if __name__ == "__main__":
    target = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "src/aureole/spectrum/data"
    print("colour-science", colour.__version__)
    write_observer(target, 1931, 2, "CIE 018:2019 / ISO/CIE 11664-1", "kObserver")
    write_observer(target, 1964, 10, "CIE 15:2004, table T.5 / ISO/CIE 11664-1", "kObserver10")
    write_scotopic(target)
    write_modified_photopic(target)
    write_illuminants(target)
