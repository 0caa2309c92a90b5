#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the folder heads and heads.txt: one small oblique grid in many formats, and what other programs read from them.

Needs numpy, nibabel 5.4.2, pynrrd 1.1.3, SimpleITK 2.5.7, vtk 9.7.2 and tifffile 2026.3.3. The grid has 5 x 4 x 3 voxels; the voxel (i, j, k)
holds 7 i + 40 j + 111 k - 100 (+ 100 where the type is unsigned). A line of heads.txt: file; parameters of the scene ("-": none); judge;
i, j, k and channel; the centre of that voxel in RAS millimetres; its value. Judges read each file by themselves: coordinates and values
come from them, except where a line says "numpy": those are made from the numbers that the file was written from.
"""
import shutil
from pathlib import Path

import nibabel
import nrrd
import numpy as np
import SimpleITK as sitk
import tifffile
import vtk
from vtk.util.numpy_support import numpy_to_vtk

here = Path(__file__).resolve().parent
heads = here / "heads"
shutil.rmtree(heads, ignore_errors=True)
heads.mkdir()
size = (5, 4, 3)
i, j, k = np.meshgrid(*map(np.arange, size), indexing="ij")
signed = 7 * i + 40 * j + 111 * k - 100  # [i, j, k]
TYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]
corners = [(0, 0, 0), (4, 0, 0), (0, 3, 0), (0, 0, 2), (4, 3, 2), (2, 1, 1)]
lines = []


def values(name):
    base = signed + 100 if name.startswith("u") else signed
    if name == "int8":
        base = base // 4
    if name == "uint8":
        base = base // 2
    return (base + 0.25 if name.startswith("float") else base).astype(name)


# An oblique frame: columns are unit vectors in RAS, the third reversed (the indices are left-handed).
a, b = np.radians([25, -15])
rotation = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) @ np.array(
    [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
directions = rotation @ np.diag([1, 1, -1.0])
spacing = np.array([0.9, 1.1, 2.5])
affine = np.eye(4)
affine[:3, :3] = directions * spacing
affine[:3, 3] = [-31.5, 12.25, 77]
to_lps = np.diag([-1.0, -1, 1, 1])


def record(file, judge, centre, value, parameters="-", channels=1):
    for at in corners:
        for c in range(channels):
            x, y, z = np.asarray(centre(at), float)[:3]
            lines.append(f"{file};{parameters};{judge};{at[0]} {at[1]} {at[2]} {c};{x:.12g} {y:.12g} {z:.12g};"
                         f"{float(value(at, c)):.9g}")


def judge_itk(file, parameters="-", frame=None):
    image = sitk.ReadImage(str(heads / file))
    if frame is not None:
        image = image[:, :, :, frame]
    def value(at, c):
        v = image.GetPixel(*at)
        return v[c] if isinstance(v, tuple) else v
    def centre(at):
        x, y, z = image.TransformIndexToPhysicalPoint(at)
        return -x, -y, z
    record(file, "SimpleITK", centre, value, parameters, image.GetNumberOfComponentsPerPixel())


def judge_nibabel(file, scale=1.0, frame=None, parameters="-"):
    image = nibabel.load(heads / file)
    data = np.asanyarray(image.dataobj)
    if frame is not None:
        data = data[..., frame]
    channels = 1
    if data.dtype.fields:
        channels = len(data.dtype.fields)
        data = np.stack([data[n] for n in data.dtype.names], -1)
    elif data.ndim > 3:
        data = data.reshape(*data.shape[:3], -1)
        channels = data.shape[3]
    record(file, "nibabel", lambda at: scale * (image.affine @ [*at, 1])[:3],
           lambda at, c: data[at][c] if channels > 1 else data[at], parameters, channels)


def judge_pynrrd(file, to_ras, parameters="-", mm=1.0):
    data, header = nrrd.read(str(heads / file))
    vectors = np.array([v for v in header["space directions"] if not np.any(np.isnan(v))])
    origin = header["space origin"]
    record(file, "pynrrd", lambda at: mm * (to_ras[:3, :3] @ (origin + np.array(at) @ vectors)),
           lambda at, c: data[at], parameters)


def judge_vtk(file, array=None, is_cell=False, parameters="-"):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(str(heads / file))
    reader.Update()
    image = reader.GetOutput()
    data = image.GetCellData() if is_cell else image.GetPointData()
    values_ = data.GetArray(array) if array else data.GetArray(0)
    low = np.array(image.GetExtent())[::2]
    def centre(at):
        if not is_cell:
            out = [0, 0, 0]
            image.TransformContinuousIndexToPhysicalPoint([float(n) for n in np.array(at) + low], out)
            return out
        box = image.GetCell(int(image.ComputeCellId([int(n) for n in np.array(at) + low]))).GetPoints()
        return np.mean([box.GetPoint(n) for n in range(box.GetNumberOfPoints())], axis=0)
    def value(at, c):
        ijk = [int(n) for n in np.array(at) + low]
        return values_.GetComponent(image.ComputeCellId(ijk) if is_cell else image.ComputePointId(ijk), c)
    record(file, "vtk", centre, value, parameters, values_.GetNumberOfComponents())


def itk_image(array):
    image = sitk.GetImageFromArray(np.ascontiguousarray(array.transpose(2, 1, 0)))
    lps = to_lps @ affine
    image.SetSpacing(spacing.tolist())
    image.SetOrigin(lps[:3, 3].tolist())
    image.SetDirection((lps[:3, :3] / spacing).ravel().tolist())
    return image


short = (signed + 100).astype("int16")  # none below 0, so that the fuzzer can render it as a medium


def fortran(array):
    return array.tobytes(order="F")


# MetaImage and NRRD of all types, written and read by ITK.
for t in TYPES:
    for ending in ("mha", "nrrd"):
        sitk.WriteImage(itk_image(values(t)), str(heads / f"{t}.{ending}"))
        judge_itk(f"{t}.{ending}")
sitk.WriteImage(itk_image(short), str(heads / "packed.mha"), True)
judge_itk("packed.mha")
sitk.WriteImage(itk_image(short), str(heads / "detached.mhd"))
judge_itk("detached.mhd")
sitk.WriteImage(itk_image(short), str(heads / "detached_packed.mhd"), True)
judge_itk("detached_packed.mhd")
vector = sitk.Compose([itk_image(short + 100 * c) for c in range(3)])
sitk.WriteImage(vector, str(heads / "vector.mha"))
judge_itk("vector.mha", "raw=true")

# MetaImage by hand: other ways to state the same.
lps = to_lps @ affine
matrix = " ".join(f"{v:.17g}" for v in (lps[:3, :3] / spacing).T.ravel())
offset = " ".join(f"{v:.17g}" for v in lps[:3, 3])
meta = (f"ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = MET_SHORT\nElementSpacing = 0.9 1.1 2.5\n"
        f"TransformMatrix = {matrix}\nOffset = {offset}\n")
big = short.astype(">i2")
(heads / "big.mha").write_bytes((meta + "BinaryData = True\nBinaryDataByteOrderMSB = True\nElementDataFile = LOCAL\n").encode() + fortran(big))
judge_itk("big.mha")
(heads / "text.mha").write_text(meta + "BinaryData = False\nElementDataFile = LOCAL\n"
                                + " ".join(str(v) for v in short.ravel(order="F")) + "\n")
judge_itk("text.mha")
for n in range(3):
    (heads / f"slice{n + 1:02d}.raw").write_bytes(b"abcdef" + fortran(short[:, :, n]))
(heads / "pattern.mhd").write_text(meta + "HeaderSize = 6\nElementDataFile = slice%02d.raw 1 3 1\n")
judge_itk("pattern.mhd")
(heads / "list.mhd").write_text(meta + "HeaderSize = -1\nElementDataFile = LIST\nslice01.raw\nslice02.raw\nslice03.raw\n")
judge_itk("list.mhd")
(heads / "centre.mha").write_bytes((meta + "CenterOfRotation = 3 2 1\nElementDataFile = LOCAL\n").encode() + fortran(short))
judge_itk("centre.mha")

# NRRD by hand.
rows = {}
for name, flip in (("right-anterior-superior", (1, 1, 1)), ("LPS", (-1, -1, 1)), ("left-anterior-superior", (-1, 1, 1))):
    m = np.diag(flip) @ affine[:3]
    rows[name] = (" ".join("(" + ",".join(f"{v:.17g}" for v in m[:, n]) + ")" for n in range(3)),
                  "(" + ",".join(f"{v:.17g}" for v in m[:, 3]) + ")")


def nrrd_header(space, extra, type_="short", sizes="5 4 3", directions_=None, dimension=3):
    d, o = rows[space]
    return (f"NRRD0005\n# a comment\ntype: {type_}\ndimension: {dimension}\nspace: {space}\nsizes: {sizes}\n"
            f"space directions: {directions_ or d}\nspace origin: {o}\nkey:=value: of the user\n" + extra)


import bz2
import gzip

ras = "right-anterior-superior"
(heads / "ras_gzip.nrrd").write_bytes(nrrd_header(ras, "endian: big\nencoding: gzip\n\n").encode() + gzip.compress(fortran(big), mtime=0))
judge_itk("ras_gzip.nrrd")
(heads / "las_bzip2.nrrd").write_bytes(nrrd_header("left-anterior-superior", "endian: little\nencoding: bz2\n\n").encode()
                                       + bz2.compress(fortran(short)))
judge_pynrrd("las_bzip2.nrrd", np.diag([-1.0, 1, 1]))
(heads / "ascii.nrrd").write_text(nrrd_header("LPS", "encoding: ascii\n\n") + "\n".join(map(str, short.ravel(order="F"))) + "\n")
judge_itk("ascii.nrrd")
(heads / "hex.nrrd").write_text(nrrd_header("LPS", "endian: little\nencoding: hex\n\n") + fortran(short).hex("\n", 20) + "\n")
judge_itk("hex.nrrd")
(heads / "skip.nhdr").write_text(nrrd_header("LPS", "endian: little\nencoding: raw\nline skip: 2\nbyte skip: 3\ndata file: skip.raw\n"))
(heads / "skip.raw").write_bytes(b"two\nlines\nxyz" + fortran(short))
judge_itk("skip.nhdr")
(heads / "end.nhdr").write_text(nrrd_header("LPS", "endian: little\nencoding: raw\nbyte skip: -1\ndata file: skip.raw\n"))
judge_itk("end.nhdr")
(heads / "list.nhdr").write_text(nrrd_header("LPS", "endian: little\nencoding: raw\nbyte skip: 6\ndata file: LIST\nslice01.raw\nslice02.raw\nslice03.raw\n"))
judge_itk("list.nhdr")
(heads / "pattern.nhdr").write_text(nrrd_header("LPS", "endian: little\nencoding: raw\nbyte skip: -1\ndata file: slice%02d.raw 1 3 1 2\n"))
judge_itk("pattern.nhdr")
(heads / "micron.nrrd").write_bytes(nrrd_header("LPS", 'endian: little\nencoding: raw\nspace units: "um" "um" "um"\n\n').encode() + fortran(short))
judge_pynrrd("micron.nrrd", np.diag([-1.0, -1, 1]), mm=1e-3)
# Frames: an axis that is none of space, the last and the slowest.
frames = np.stack([short, short + 1000], -1)
(heads / "frames.nrrd").write_bytes(nrrd_header("LPS", "endian: little\nencoding: raw\nkinds: domain domain domain list\n\n", sizes="5 4 3 2",
                                                directions_=rows["LPS"][0] + " none", dimension=4).encode() + fortran(frames))
data, header = nrrd.read(str(heads / "frames.nrrd"))
for frame in (0, 1):
    record("frames.nrrd", "pynrrd", lambda at: np.diag([-1.0, -1, 1]) @ (header["space origin"] + np.array(at) @ header["space directions"][:3]),
           lambda at, c, frame=frame: data[at][frame], f"frame={frame}")
sitk.WriteImage(vector, str(heads / "vector.nrrd"))
judge_itk("vector.nrrd", "raw=true")
# No space: spacings and the positions of the first samples, with both centerings.
plain = "NRRD0001\ntype: short\ndimension: 3\nsizes: 5 4 3\nencoding: raw\nendian: little\n"
for name, extra in (("spacings", "spacings: 0.9 1.1 2.5\n"), ("mins_cell", "spacings: 0.9 1.1 2.5\naxis mins: 1 2 3\ncenterings: cell cell cell\n"),
                    ("mins_node", "spacings: 0.9 1.1 2.5\naxis mins: 1 2 3\ncenters: node node node\n")):
    (heads / f"{name}.nrrd").write_bytes((plain + extra + "\n").encode() + fortran(short))
    image = sitk.ReadImage(str(heads / f"{name}.nrrd"))  # without a space ITK's coordinates are the file's
    record(f"{name}.nrrd", "SimpleITK", lambda at, image=image: image.TransformIndexToPhysicalPoint(at),
           lambda at, c, image=image: image.GetPixel(*at))
# ITK takes 1 for a spacing that follows from the ends of the axes. The definition of the format: from the first node to the last, or from
# the outer face of the first cell to that of the last.
low, high = np.array([1, 2, 3]), np.array([6, 10, 6])
for name, first, step in (("cell", 0.5, (high - low) / size), ("node", 0, (high - low) / (np.array(size) - 1))):
    (heads / f"range_{name}.nrrd").write_bytes((plain + f"axismins: 1 2 3\naxismaxs: 6 10 6\ncenterings: {name} {name} {name}\n\n").encode()
                                               + fortran(short))
    record(f"range_{name}.nrrd", "numpy", lambda at, step=step, first=first: low + step * (np.array(at) + first), lambda at, c: short[at])

# NIfTI.
for t in TYPES:
    image = nibabel.Nifti1Image(values(t), affine, dtype=t)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, heads / f"{t}.nii")
    judge_nibabel(f"{t}.nii")


def nifti(file, array=short, cls=nibabel.Nifti1Image, change=None, scale=1.0, frame=None, parameters="-", header=None):
    image = cls(array, affine, header=header, dtype=array.dtype if array.dtype.names is None else None)
    image.header.set_xyzt_units("mm")
    if change:
        change(image)
    nibabel.save(image, heads / file)
    judge_nibabel(file, scale, frame, parameters)


def only_qform(image):
    image.set_qform(affine, 1)
    image.set_sform(None, 0)


def other_sform(image):  # sform is preferred
    image.set_qform(np.diag([9.0, 9, 9, 1]), 2)
    image.set_sform(affine, 4)


def micrometres(image):
    image.header.set_xyzt_units("micron")


nifti("qform.nii", change=only_qform)
nifti("sform.nii", change=other_sform)
nifti("micron.nii", change=micrometres, scale=1e-3)
nifti("packed.nii.gz")
nifti("second.nii", cls=nibabel.Nifti2Image)
nifti("second_qform.nii.gz", cls=nibabel.Nifti2Image, change=only_qform)
nifti("pair.hdr", cls=nibabel.Nifti1Pair)
nifti("big.nii", header=nibabel.Nifti1Header(endianness=">"))
nifti("big_second.nii", cls=nibabel.Nifti2Image, header=nibabel.Nifti2Header(endianness=">"))
for frame in (0, 1):
    nifti("frames.nii", np.stack([short, short + 1000], -1), frame=frame, parameters=f"frame={frame}")
rgb = np.zeros(size, dtype=[("R", "u1"), ("G", "u1"), ("B", "u1")])
for n, name in enumerate("RGB"):
    rgb[name] = values("uint8") // (n + 1)
nifti("rgb.nii", rgb, parameters="raw=true")
nifti("vector.nii", np.stack([short, short + 100, short + 200], -1)[:, :, :, None, :], parameters="raw=true")
for name, slope, intercept in (("slope", 0.5, 7.25), ("slope_zero", 0, 3), ("slope_nan", np.nan, np.nan)):
    raw = bytearray((heads / "sform.nii").read_bytes())
    raw[112:120] = np.array([slope, intercept], "<f4").tobytes()
    (heads / f"{name}.nii").write_bytes(raw)
    judge_nibabel(f"{name}.nii")

# .vti: coordinates are the world's as they are.


def vti(file, array=short, mode="appended", encode=False, compressor="None", is_cell=False, low=(0, 0, 0), header64=False, big_endian=False,
        names=("density",), parameters="-", judged=None):
    image = vtk.vtkImageData()
    n = np.array(array.shape[:3]) + (1 if is_cell else 0)
    image.SetExtent(*[int(v) for pair in zip(low, np.array(low) + n - 1) for v in pair])
    image.SetSpacing(*spacing)
    origin = affine[:3, 3] - affine[:3, :3] @ np.array(low)
    image.SetOrigin(*origin)
    image.SetDirectionMatrix(*directions.ravel())
    for number, name in enumerate(names):
        channels = array.shape[3] if array.ndim == 4 else 1
        flat = (array + number).reshape(-1, channels, order="F") if channels == 1 else np.stack(
            [(array[..., c] + number).ravel(order="F") for c in range(channels)], -1)
        numbers = numpy_to_vtk(np.ascontiguousarray(flat), deep=True)
        numbers.SetName(name)
        (image.GetCellData() if is_cell else image.GetPointData()).AddArray(numbers)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(heads / file))
    writer.SetInputData(image)
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary, "appended": writer.SetDataModeToAppended}[mode]()
    writer.SetEncodeAppendedData(encode)
    getattr(writer, "SetCompressorTypeTo" + compressor)()
    writer.SetBlockSize(64)
    writer.SetHeaderTypeToUInt64() if header64 else writer.SetHeaderTypeToUInt32()
    writer.SetByteOrderToBigEndian() if big_endian else writer.SetByteOrderToLittleEndian()
    writer.Write()
    judge_vtk(file, judged or names[0], is_cell, parameters)


for t in TYPES:
    vti(f"{t}.vti", values(t))
vti("ascii.vti", mode="ascii")
vti("ascii_float.vti", short + 0.25, mode="ascii")
vti("binary.vti", mode="binary", header64=True)
vti("binary_packed.vti", mode="binary", compressor="ZLib")
vti("appended_base64.vti", encode=True)
vti("appended_base64_packed.vti", encode=True, compressor="ZLib", header64=True)
vti("appended_packed.vti", compressor="ZLib")
vti("appended_lz4.vti", compressor="LZ4")
vti("binary_lz4.vti", mode="binary", compressor="LZ4")
vti("appended_lzma.vti", compressor="LZMA")
vti("big.vti", big_endian=True, compressor="ZLib")
vti("cell.vti", is_cell=True)
vti("extent.vti", low=(3, -2, 7))
vti("extent_cell.vti", low=(3, -2, 7), is_cell=True)
vti("named.vti", names=("density", "two"), judged="two", parameters="array=two")
vti("vector.vti", np.stack([short, short + 100, short + 200], -1), parameters="raw=true")

# Arrays and pictures, placed by parameters: centres by numpy.
placed = "spacing=0.9,1.1,2.5 origin=1,2,3"


def judge_numpy(file, array, parameters=placed):  # array[i, j, k]
    record(file, "numpy", lambda at: np.array([1, 2, 3]) + spacing * np.array(at), lambda at, c: array[at], parameters)


for t in (*TYPES, "float16"):
    array = (values(t) if t != "float16" else (signed / 4).astype("float16"))
    np.save(heads / f"{t}.npy", np.ascontiguousarray(array.transpose(2, 1, 0)))
    judge_numpy(f"{t}.npy", np.load(heads / f"{t}.npy").transpose(2, 1, 0))
np.save(heads / "fortran.npy", np.asfortranarray(short.transpose(2, 1, 0)))
judge_numpy("fortran.npy", np.load(heads / "fortran.npy").transpose(2, 1, 0))
np.save(heads / "big.npy", np.ascontiguousarray(short.transpose(2, 1, 0)).astype(">i2"))
judge_numpy("big.npy", np.load(heads / "big.npy").transpose(2, 1, 0))
for t in ("uint8", "int16", "uint16", "float32"):
    tifffile.imwrite(heads / f"{t}.tif", np.ascontiguousarray(values(t).transpose(2, 1, 0)), photometric="minisblack", metadata=None)
    judge_numpy(f"{t}.tif", tifffile.imread(heads / f"{t}.tif").transpose(2, 1, 0))
tifffile.imwrite(heads / "packed.tif", np.ascontiguousarray(values("uint16").transpose(2, 1, 0)), compression="zlib", metadata=None,
                 byteorder=">", photometric="minisblack")
judge_numpy("packed.tif", tifffile.imread(heads / "packed.tif").transpose(2, 1, 0))
tifffile.imwrite(heads / "imagej.tif", np.ascontiguousarray(values("uint16").transpose(2, 1, 0)), imagej=True)
judge_numpy("imagej.tif", tifffile.imread(heads / "imagej.tif").transpose(2, 1, 0))
# Two instants of two channels: ImageJ stores the channels of a slice side by side, this OME-TIFF all instants of a channel.
several = np.stack([[values("uint16").transpose(2, 1, 0) + 1000 * (2 * t + c) for c in range(2)] for t in range(2)])  # [t, c, z, y, x]
tifffile.imwrite(heads / "hyper.tif", np.ascontiguousarray(several.transpose(0, 2, 1, 3, 4)), imagej=True, resolution=(2, 4),
                 metadata={"axes": "TZCYX", "spacing": 2.5, "unit": "um"})
tifffile.imwrite(heads / "several.ome.tif", np.ascontiguousarray(several.transpose(1, 0, 2, 3, 4)), metadata={"axes": "CTZYX"})
for t, c in ((0, 0), (0, 1), (1, 0), (1, 1)):
    judge_numpy("hyper.tif", tifffile.imread(heads / "hyper.tif")[t, :, c].transpose(2, 1, 0), placed + f" frame={2 * t + c}")
    judge_numpy("several.ome.tif", tifffile.imread(heads / "several.ome.tif")[c, t].transpose(2, 1, 0), placed + f" frame={2 * c + t}")
for n in range(3):
    tifffile.imwrite(heads / f"series{n + 8}.tif", np.ascontiguousarray(values("uint16")[:, :, n].T), metadata=None, photometric="minisblack")
judge_numpy("series9.tif", values("uint16"), placed + " series=true")

(here / "heads.txt").write_text("\n".join(lines) + "\n")
print(len(lines), "lines,", len(list(heads.iterdir())), "files,", sum(f.stat().st_size for f in heads.iterdir()), "bytes")
