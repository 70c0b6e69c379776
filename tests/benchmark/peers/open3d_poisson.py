"""Open3D's sample_points_poisson_disk: seconds without reading the file, as one JSON object.

usage: open3d_poisson.py MESH COUNT
"""

import json
import sys
import time

import open3d

mesh = open3d.io.read_triangle_mesh(sys.argv[1])
count = int(sys.argv[2])
if not mesh.has_triangles():
    sys.exit(f"open3d_poisson.py: no triangles in {sys.argv[1]}")
start, before = time.perf_counter(), time.process_time()
cloud = mesh.sample_points_poisson_disk(count)
print(json.dumps({"count": len(cloud.points), "seconds": time.perf_counter() - start,
                  "processor_seconds": time.process_time() - before}))
