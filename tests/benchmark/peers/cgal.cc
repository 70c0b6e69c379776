// Isotropic remeshing of CGAL, one thread: seconds without reading the file, as one JSON object.
// Vertices come near the number asked for, not exactly: the only dial is the length of edges.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>
#include <CLI/CLI.hpp>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace processing = CGAL::Polygon_mesh_processing;

}  // namespace

int main(int argc, char** argv) {
  std::string path;
  double count = 10'000;
  unsigned iterations = 3;
  CLI::App app("Remeshes a surface isotropically with CGAL and prints what it took as JSON");
  app.add_option("--mesh", path, "a file")->required();
  app.add_option("--count", count, "vertices wanted")->check(CLI::Range(4.0, 1e8));
  app.add_option("--iterations", iterations, "rounds of splits, collapses, flips and moves");
  CLI11_PARSE(app, argc, argv);

  Mesh mesh;
  if (!processing::IO::read_polygon_mesh(path, mesh)) {
    std::fprintf(stderr, "ccst_peer_cgal: cannot read %s as a manifold\n", path.c_str());
    return 2;
  }
  // Edges of a hexagonal lattice with `count` points.
  const double length = std::sqrt(2.0 * processing::area(mesh) / (std::sqrt(3.0) * count));
  const std::clock_t before = std::clock();
  const auto start = std::chrono::steady_clock::now();
  processing::isotropic_remeshing(mesh.faces(), length, mesh,
                                  CGAL::parameters::number_of_iterations(iterations));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const double processor = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  mesh.collect_garbage();
  std::printf("{\"count\": %zu, \"seconds\": %.6f, \"processor_seconds\": %.6f}\n",
              static_cast<std::size_t>(mesh.number_of_vertices()), seconds.count(), processor);
  return 0;
}
