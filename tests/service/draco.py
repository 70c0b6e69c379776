"""Made-up meshes as Draco streams, written by hand: bitstream 2.2, sequential, uncompressed."""

import math
import random
import struct

FLOAT32 = 9
POSITION, GENERIC = 0, 4


def _varint(value):
    result = bytearray()
    while value >= 0x80:
        result.append(value & 0x7F | 0x80)
        value >>= 7
    result.append(value)
    return bytes(result)


def _metadata(attribute_id, name):
    """One attribute's metadata: its name; and none of the file's."""
    entry = b"\x04name" + _varint(len(name)) + name.encode()
    return _varint(1) + _varint(attribute_id) + _varint(1) + entry + _varint(0) + b"\x00\x00"


def encode(positions, faces, scalar=None, name="weight"):
    """A Draco stream of V positions (x, y, z), F faces and maybe V scalars called `name`."""
    count = len(positions)
    stream = b"DRACO" + bytes([2, 2, 1, 0]) + struct.pack("<H", 0x8000 if scalar else 0)
    if scalar:
        stream += _metadata(1, name)
    indices = [i for face in faces for i in face]
    stream += _varint(len(faces)) + _varint(count) + b"\x01"
    if count < 256:
        stream += bytes(indices)
    elif count < 65536:
        stream += struct.pack(f"<{len(indices)}H", *indices)
    else:
        stream += b"".join(map(_varint, indices))
    columns = [(POSITION, 3, [x for p in positions for x in p])]
    if scalar:
        columns.append((GENERIC, 1, list(scalar)))
    stream += b"\x01" + _varint(len(columns))
    for identifier, (kind, width, _) in enumerate(columns):
        stream += bytes([kind, FLOAT32, width, 0]) + _varint(identifier)
    stream += b"\x00" * len(columns)
    for _, _, values in columns:
        stream += struct.pack(f"<{len(values)}f", *values)
    return stream


def torus(around=24, across=12, large=1.0, small=0.35):
    """Positions and faces of a torus around the z axis."""
    positions, faces = [], []
    for i in range(around):
        for j in range(across):
            a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
            r = large + small * math.cos(b)
            positions.append((r * math.cos(a), r * math.sin(a), small * math.sin(b)))

            def vertex(k, l):
                return k % around * across + l % across

            corners = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
            faces += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
    return positions, faces


def mutate(stream, rng: random.Random):
    """The stream cut short, with bytes changed, or with a stretch taken out or repeated."""
    data = bytearray(stream)
    kind = rng.randrange(4)
    if kind == 0:
        return bytes(data[: rng.randrange(len(data))])
    if kind == 1:
        for _ in range(rng.choice((1, 2, 8, 64))):
            data[rng.randrange(len(data))] = rng.randrange(256)
        return bytes(data)
    # The first bytes decide most.
    begin = rng.randrange(min(len(data), 64))
    end = min(len(data), begin + rng.randrange(1, 32))
    return bytes(data[:begin] + (data[begin:end] * 2 if kind == 2 else b"") + data[end:])
