#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders the scenes of the table "Faults of Mitsuba 3.9.1" in docs/mitsuba.md with Mitsuba and with aureole, and
prints both beside the right value: needs `pip install mitsuba==3.9.1` and the path of the program.

    tools/mitsuba_faults.py build/release/bin/aureole"""
import math
import os
import struct
import subprocess
import sys
import tempfile

import mitsuba
import numpy

mitsuba.set_variant("scalar_spectral")

FILM = ('<film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/><rfilter type="box"/>'
        '<string name="pixel_format" value="luminance"/></film>')


def camera(samples):
    return ('<sensor type="perspective"><float name="fov" value="1"/><transform name="to_world"><lookat origin="0, 0, 5" '
            f'target="0, 0, 0" up="0, 1, 0"/></transform>{FILM}<sampler type="independent">'
            f'<integer name="sample_count" value="{samples}"/></sampler></sensor>')


FILES = tempfile.TemporaryDirectory()
SKY = '<emitter type="constant"/>'
BLACK = '<bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf>'


def band(low, high):
    """A sky from `low` to `high` nm, of luminance 1."""
    scale = 106.857 / sum(float(numpy.array(mitsuba.cie1931_xyz(nm)).ravel()[1]) for nm in numpy.arange(low + 0.5, high))
    return f'<emitter type="constant"><spectrum name="radiance" value="{low}:{scale}, {high}:{scale}"/></emitter>'


def path(content, samples=4096):
    return '<integrator type="path"/>' + camera(samples) + SKY + content


def checkerboard():
    squares = ('<texture type="checkerboard" name="opacity"><float name="color0" value="0"/><float name="color1" '
               'value="1"/><transform name="to_uv"><scale value="0.0001"/></transform></texture>')
    return path(f'<shape type="rectangle"><bsdf type="mask">{squares}{BLACK}</bsdf></shape>', 256), 1


def point_lights():
    return ('<integrator type="direct"><integer name="emitter_samples" value="2"/></integrator>' + camera(64) +
            '<shape type="rectangle"/><emitter type="point"><point name="position" x="0" y="0" z="1"/></emitter>',
            0.5 / math.pi)


def blend():
    return path('<shape type="rectangle"><bsdf type="blendbsdf"><float name="weight" value="0.25"/>' + BLACK +
                '<bsdf type="conductor"><string name="material" value="none"/></bsdf></bsdf></shape>'), .25


def rotation():
    # The width of a rectangle turned by 60 degrees about y is halved and the height stays: it covers the view above 0.9.
    view = camera(256).replace('"0, 0, 5"', '"0, 2, 5"').replace('target="0, 0, 0"', 'target="0, 2, 0"')
    return ('<integrator type="path"/>' + view + SKY + '<shape type="rectangle"><transform name="to_world"><rotate y="2" '
            f'angle="60"/></transform>{BLACK}</shape>'), 1


def meter():
    floor = ('<shape type="rectangle"><transform name="to_world"><scale value="1e5"/><rotate x="1" angle="-90"/>'
             f'<translate y="-1.001"/></transform>{BLACK}</shape>')
    film = FILM.replace('value="4"', 'value="1"')
    sensor = (f'<sensor type="irradiancemeter">{film}<sampler type="independent"><integer name="sample_count" '
              'value="16384"/></sampler></sensor>')
    return ('<integrator type="path"/>' + SKY + floor + '<shape type="sphere"><transform name="to_world"><rotate x="1" '
            f'angle="90"/></transform>{sensor}</shape>'), math.pi / 2


def clear_at_some_wavelengths():
    # Light passes the slab unchanged below 550 nm; above, 1/e of it. Mitsuba's volpathmis gives the right value.
    slab = ('<shape type="cube"><transform name="to_world"><scale x="100" y="100" z="0.5"/></transform><bsdf type="null"/>'
            '<medium type="homogeneous" name="interior"><spectrum name="sigma_t" value="360:0, 549:0, 551:1, 830:1"/><float '
            'name="albedo" value="0"/></medium></shape>')
    return path(slab, 4096).replace('type="path"', 'type="volpath"'), None


def melanin():
    # All light that meets a fibre at its middle leaves it, but for what eumelanin absorbs. d'Eon et al. (2011) have
    # 1.37 per radius in the blue; the spectrum of a reflectance, by which Mitsuba upsamples it, ends at 1.
    sky = band(440, 460)
    fibre = ('<bsdf type="hair"><float name="eumelanin" value="1"/><float name="pheomelanin" value="0"/><float '
             'name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>')
    through = math.exp(-2 * 1.37)
    return ('<integrator type="path"/>' + camera(16384) + sky + f'<shape type="rectangle">{fibre}</shape>',
            .04 + .96**2 * through / (1 - .04 * through))


def flat_grid():
    # A plane that fills the view, on a grid of 2 x 2 x 9 nodes.
    with open(os.path.join(FILES.name, "plane.vol"), "wb") as file:
        file.write(b"VOL\x03" + struct.pack("<5i6f", 1, 2, 2, 9, 1, 0, 0, 0, 1, 1, 1))
        file.write((numpy.repeat(numpy.linspace(0, 1, 9), 4) - .45).astype("<f4").tobytes())
    return path(f'<shape type="sdfgrid"><string name="filename" value="{file.name}"/><transform name="to_world"><translate '
                f'x="-0.5" y="-0.5"/><scale x="9" y="9"/></transform>{BLACK}</shape>', 64), 0


def between_texels():
    # The view is halfway between white texels and black ones.
    sky = numpy.zeros((5, 8, 3), numpy.float32)
    sky[1:4, 0] = 1
    file = os.path.join(FILES.name, "sun.exr")
    mitsuba.Bitmap(sky).write(file)
    return ('<integrator type="path"/>' + camera(1024) +
            f'<emitter type="envmap"><string name="filename" value="{file}"/></emitter>'), .5


def lamp_behind_null():
    # A disk of radius 5 irradiates the floor 5 below it with half its radiosity. The camera is below the null surface.
    # Mitsuba moves a ray off a null surface by about 9e-5 (1 + largest coordinate) and does not count that step, but ends
    # shadow rays 9e-4 of their length before the light. The step is longer here, so that the light occludes itself.
    view = camera(4096).replace('"0, 0, 5"', '"100, 0, 1"').replace('target="0, 0, 0"', 'target="100, 0, 0"')
    return ('<integrator type="volpath"/>' + view +
            '<shape type="rectangle"><transform name="to_world"><scale value="50"/><translate x="100"/></transform></shape>'
            '<shape type="disk"><transform name="to_world"><scale value="5"/><rotate x="1" angle="180"/><translate x="100" '
            'z="5"/></transform><emitter type="area"><float name="radiance" value="1"/></emitter></shape>'
            '<shape type="rectangle"><transform name="to_world"><scale value="25"/><translate x="100" z="2.5"/></transform>'
            '<bsdf type="null"/></shape>'), .25


def masked_floor():
    # Mitsuba returns no light for a path that crosses null surfaces and then leaves a scene without environment, and drops
    # with it what light sampling found at the mask. A fraction 1 - opacity of all paths is lost.
    floor = ('<shape type="rectangle"><bsdf type="mask"><float name="opacity" value="0.4"/><bsdf type="diffuse"/></bsdf>'
             '</shape><emitter type="point"><point name="position" x="0" y="0" z="1"/></emitter>')
    return '<integrator type="path"/>' + camera(4096) + floor, .4 * .5 / math.pi


def slab(extinction, view):
    """A white sky behind a cube of an absorbing medium, 2 thick."""
    return ('<integrator type="volpathmis"/>' + view + SKY + '<shape type="cube"><bsdf type="null"/><medium '
            f'type="heterogeneous" name="interior">{extinction}<float name="albedo" value="0"/></medium></shape>')


def coloured_grid():
    # One colour in all voxels gives another spectrum than the same <rgb>, which Mitsuba renders for comparison: scaled so
    # that its largest component is 1/2, upsampled and scaled back.
    with open(os.path.join(FILES.name, "red.vol"), "wb") as file:
        file.write(b"VOL\x03" + struct.pack("<5i6f", 1, 2, 2, 2, 3, 0, 0, 0, 1, 1, 1) + struct.pack("<3f", .8, .1, .1) * 8)
    view = camera(65536).replace('origin="0, 0, 5"', 'origin="0.5, 0.5, 5"').replace('target="0, 0, 0"',
                                                                                     'target="0.5, 0.5, 0"')
    grid = f'<volume type="gridvolume" name="sigma_t"><string name="filename" value="{file.name}"/></volume>'
    unit = ('<transform name="to_world"><scale value="0.5"/><translate x="0.5" y="0.5" z="0.5"/></transform>'
            '<bsdf type="null"/>')
    scenes = [slab(extinction, view).replace('<bsdf type="null"/>', unit).replace(SKY, band(640, 660))
              for extinction in (grid, '<rgb name="sigma_t" value="0.8, 0.1, 0.1"/>')]
    return scenes[0], of_mitsuba(scenes[1])


def constant_extinction():
    # The view is a quarter beside the axis, so that it meets the unit cube from z = 0 to 1 within the cube from -1 to 1.
    view = camera(65536).replace('origin="0, 0, 5"', 'origin="0.25, 0.25, 5"').replace('target="0, 0, 0"',
                                                                                    'target="0.25, 0.25, 0"')
    return slab('<float name="sigma_t" value="1"/>', view), math.exp(-2)


CASES = {"checkerboard read as a number": checkerboard, "direct: two samples of a point light": point_lights,
         "blendbsdf of a mirror and black": blend, "rotate about an axis of length 2": rotation,
         "irradiancemeter on a turned sphere": meter, "no extinction below 550 nm": clear_at_some_wavelengths,
         "eumelanin of hair, 440 to 460 nm": melanin, "sdfgrid of 2 x 2 x 9 nodes": flat_grid,
         "envmap between white and black": between_texels,
         "volpath: lamp behind a null surface": lamp_behind_null, "path: masked floor, point light": masked_floor,
         "gridvolume of one colour": coloured_grid, "heterogeneous, constant sigma_t": constant_extinction}


def of_mitsuba(content):
    return float(numpy.array(mitsuba.render(mitsuba.load_string(f'<scene version="3.0.0">{content}</scene>'))).mean())


def of_aureole(program, content):
    with tempfile.TemporaryDirectory() as folder:
        scene, picture = os.path.join(folder, "scene.xml"), os.path.join(folder, "out.exr")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(f'<scene version="3.0.0">{content}</scene>')
        subprocess.run([program, "render", scene, "-o", picture, "-q"], check=True)
        return float(numpy.array(mitsuba.Bitmap(picture)).mean())


def main():
    for name, case in CASES.items():
        content, right = case()
        ours = of_aureole(sys.argv[1], content) if len(sys.argv) > 1 else math.nan
        print(f"{name:40} Mitsuba {of_mitsuba(content):8.4f}   aureole {ours:8.4f}   right "
              f"{'?' if right is None else f'{right:.4f}'}")


if __name__ == "__main__":
    main()
