"""Meshes made by code, for figures that need no model, written as OFF or OBJ."""

import math


def _grid(columns, rows, point, wrap=False):
    """(vertices, faces) over [0, 1]^2, faces counter-clockwise in (u, v); u closes with wrap."""
    across = columns if wrap else columns + 1
    vertices = [
        point(i / columns, j / rows) for j in range(rows + 1) for i in range(across)
    ]
    faces = []
    for j in range(rows):
        for i in range(columns):
            a, b = j * across + i, j * across + (i + 1) % across
            c, d = b + across, a + across
            faces += [(a, b, c), (a, c, d)]
    return vertices, faces


def plane(width, height):
    return _grid(40, 40, lambda u, v: (width * u, height * v, 0.0))


def cylinder(circumference, height):
    """Unrolls to [0, circumference] x [0, height]."""
    radius = circumference / (2 * math.pi)

    def point(u, v):
        a = 2 * math.pi * u
        return (radius * math.cos(a), radius * math.sin(a), height * v)

    return _grid(720, 20, point, wrap=True)


def cone(near, far):
    """A cone of half angle 30 degrees between the slant distances near and far from its tip, at
    the origin; unrolls to half a ring."""

    def point(u, v):
        slant = near + (far - near) * v
        a = -2 * math.pi * u
        return (0.5 * slant * math.cos(a), 0.5 * slant * math.sin(a), slant * math.sqrt(0.75))

    return _grid(720, 20, point, wrap=True)


def blob(around=96, across=48):
    """A closed surface of genus 1 whose tube swells and thins."""

    def point(u, v):
        a, b = 2 * math.pi * u, 2 * math.pi * v
        tube = 0.32 + 0.1 * math.cos(3 * a)
        ring = 1.0 + tube * math.cos(b)
        return (ring * math.cos(a), ring * math.sin(a), tube * math.sin(b) + 0.12 * math.sin(2 * a))

    vertices, faces = _grid(around, across, point, wrap=True)
    last = around * across
    wrapped = [tuple(v - last if v >= last else v for v in face) for face in faces]
    return vertices[:last], wrapped


def write_off(path, mesh):
    vertices, faces = mesh
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        for x, y, z in vertices:
            file.write(f"{x!r} {y!r} {z!r}\n")
        for a, b, c in faces:
            file.write(f"3 {a} {b} {c}\n")
    return path


def write_textured_sphere(path, columns=96, rows=48):
    """An OBJ of a sphere with texture coordinates over longitude and latitude."""

    def point(u, v):
        a, b = 2 * math.pi * u, math.pi * (v - 0.5)
        return (math.cos(a) * math.cos(b), math.sin(b), -math.sin(a) * math.cos(b), u, v)

    vertices, faces = _grid(columns, rows, point)
    with open(path, "w") as file:
        for x, y, z, u, v in vertices:
            file.write(f"v {x:.15g} {y:.15g} {z:.15g}\nvt {u:.15g} {v:.15g}\n")
        for face in faces:
            file.write("f " + " ".join(f"{i + 1}/{i + 1}" for i in face) + "\n")
    return path
